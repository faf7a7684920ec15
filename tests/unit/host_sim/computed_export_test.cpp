// SPDX-License-Identifier: Apache-2.0
// What is computed from a recording reaches the formats with unit and provenance, and is read back;
// measurements stay what they were.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "exports/computed_series.h"
#include "exports/even_times.h"
#include "exports/export_estimates.h"
#include "hosted/files/input_error.h"
#include "recordings/analog_channels.h"
#include "support/export_content.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing_support::read_file;
using testing_support::read_points;
using testing_support::ReadPoints;
using testing_support::TemporaryFolder;
using testing_support::write_export;

constexpr double kFloat = 0x1p-24;
constexpr int kSamples = 300;

bool never(double) {
  return false;
}

// A point at 100 Hz that opens and closes, with a little noise; with a drive if `has_drive`.
std::string one_point(bool has_drive) {
  std::string text = has_drive ? "time_s,jaw_x_mm,jaw_y_mm,jaw_z_mm,drive_N\n"
                               : "time_s,jaw_x_mm,jaw_y_mm,jaw_z_mm\n";
  for (int k = 0; k < kSamples; ++k) {
    const auto noise = [k](double seed) { return 0.02 * std::sin(seed * k * k); };
    text += fmt::format("{:.2f},{:.4f},{:.4f},{:.4f}", k * 0.01, 10 * std::sin(0.06 * k) + noise(1),
                        80 + 3 * std::sin(0.05 * k) + noise(2),
                        -30 + 5 * std::cos(0.06 * k) + noise(3));
    text += has_drive ? fmt::format(",{:.4f}\n", 2 * std::cos(0.06 * k)) : "\n";
  }
  return text;
}

ExportData with_estimates(const std::string& path, std::optional<double> resample_Hz = {}) {
  ExportData data = read_export_data(path, {}, never);
  if (resample_Hz) resample(data, *resample_Hz);
  data.estimates =
      std::make_shared<ExportEstimates>(path, RecordingChoice{}, resample_Hz, [] { return false; });
  add_estimate_series(data);
  return data;
}

const ExportSeries& series_of(const ExportData& data, const std::string& name,
                              const std::string& quantity) {
  for (const ExportSeries& one : data.series) {
    if (one.name == name && one.quantity == quantity) return one;
  }
  throw InputError(name + " " + quantity + " is not there");
}

std::string point_file(const TemporaryFolder& folder) {
  return folder.write("point.csv", one_point(false));
}

TEST(ComputedExport, EstimatesAreThoseOfTheEstimatorAtTheSamples) {
  const TemporaryFolder folder;
  const std::string path = point_file(folder);
  const ExportData data = with_estimates(path);
  const ExportSeries& velocity = series_of(data, "estimate", "velocity");
  const ExportSeries& sd = series_of(data, "estimate", "velocity_sd");
  ExportEstimates again(path, {}, {}, [] { return false; });
  std::size_t k = 0, measured = 0;
  again.run([&](const EstimateRow& row) {
    ASSERT_EQ(row.time_ns, data.time_ns[k]);
    for (std::size_t i = 0; i < 3; ++i) {
      const Quantity<double>& expected = row.axes[i].velocity_m_s;
      EXPECT_TRUE(velocity.at(k)[i] == expected.value ||
                  (std::isnan(velocity.at(k)[i]) && std::isnan(expected.value)));
      EXPECT_EQ(velocity.provenance_at(k, i), expected.provenance);
      measured += expected.provenance == Provenance::measured ? 1U : 0U;
      if (std::isfinite(expected.value)) {
        EXPECT_EQ(sd.at(k)[i], expected.standard_deviation);
      }
    }
    ++k;
  });
  EXPECT_EQ(k, data.samples());
  EXPECT_GT(measured, data.samples());
  // The first samples say nothing yet: no file may call them measured.
  EXPECT_NE(velocity.provenance_at(1, 0), Provenance::measured);
  EXPECT_NE(velocity.provenance, Provenance::measured);
  EXPECT_THAT(series_of(data, "estimate", "force").assumption, HasSubstr("assumed mass of"));
  EXPECT_THROW(series_of(data, "estimate", "mass"), InputError);
}

TEST(ComputedExport, FrictionAndMassComeWithADriveOnly) {
  const TemporaryFolder folder;
  const ExportData data = with_estimates(folder.write("driven.csv", one_point(true)));
  EXPECT_EQ(series_of(data, "estimate", "mass").unit, "kg");
  EXPECT_EQ(series_of(data, "estimate", "friction").values.size(), data.samples());
}

TEST(ComputedExport, C3dHoldsEstimatesAsAPointAndChannels) {
  const TemporaryFolder folder;
  const ExportData data = with_estimates(point_file(folder));
  write_export(export_c3d, data, folder / "jaw.c3d");
  const ReadPoints read = read_points(folder / "jaw.c3d");
  ASSERT_THAT(read.names, testing::ElementsAre("jaw", "estimate"));
  const ExportSeries& position = series_of(data, "estimate", "position");
  const ExportSeries& velocity = series_of(data, "estimate", "velocity");
  const auto reader = open_analog(
      folder / "jaw.c3d",
      {"estimate_velocity_x", "estimate_velocity_sd_x", "estimate_velocity_x_provenance"},
      FaultPolicy::event);
  EXPECT_EQ(reader->channels()[0].unit, "mm/s");
  EXPECT_EQ(reader->channels()[1].unit, "mm/s");
  for (std::size_t k = 0; k < data.samples(); ++k) {
    ASSERT_TRUE(reader->next());
    const double expected_mm_s = velocity.at(k)[0] * 1e3;
    EXPECT_EQ(std::isfinite(reader->values()[0]), std::isfinite(expected_mm_s));
    if (std::isfinite(expected_mm_s)) {
      EXPECT_NEAR(reader->values()[0], expected_mm_s, kFloat * std::abs(expected_mm_s));
    }
    EXPECT_EQ(reader->values()[2], static_cast<double>(velocity.provenance_at(k, 0)));
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double expected_m = position.at(k)[axis];
      if (!position.is_there(k)) continue;
      EXPECT_NEAR(read.points_m[k](axis, 1), expected_m, 2 * kFloat * std::abs(expected_m));
    }
  }
}

// Tables that condyle reads itself: the measurements come back as before, the estimates are named
// and not taken for measurements.
TEST(ComputedExport, ReadersDoNotTakeEstimatesForMeasurements) {
  const TemporaryFolder folder;
  const ExportData data = with_estimates(point_file(folder));
  const std::pair<Exporter, std::string> formats[] = {
#ifdef CONDYLE_HAS_MATIO
      {export_mat, "jaw.mat"},
#endif
      {export_wide_csv, "jaw.csv"},
      {export_xdf, "jaw.xdf"}};
  for (const auto& [write, name] : formats) {
    write_export(write, data, folder / name);
    const ReadPoints read = read_points(folder / name);
    ASSERT_THAT(read.names, testing::ElementsAre("jaw")) << name;
    EXPECT_EQ(read.time_ns, data.time_ns) << name;
    for (std::size_t k = 0; k < data.samples(); ++k) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(read.points_m[k](axis, 0), data.series[0].at(k)[axis], 1e-15) << name;
      }
    }
    if (name != "jaw.xdf") {
      EXPECT_THAT(read.info.notes, Contains(HasSubstr("estimate_"))) << name;
    }
  }
}

TEST(ComputedExport, TablesStateTheProvenanceOfEachValue) {
  const TemporaryFolder folder;
  const ExportData data = with_estimates(point_file(folder));
  write_export(export_long_csv, data, folder / "long.csv");
  const std::string text = read_file(folder / "long.csv");
  EXPECT_THAT(text, AllOf(HasSubstr("\n0.01,estimate,velocity,x,"), HasSubstr(",mm/s,assumed\n"),
                          HasSubstr(",mm/s,measured\n"), HasSubstr(",N,derived\n")));
  write_export(export_wide_csv, data, folder / "wide.csv");
  const std::string wide = read_file(folder / "wide.csv");
  EXPECT_THAT(wide.substr(0, wide.find('\n')),
              AllOf(HasSubstr("jaw_z_mm,estimate_position_x_mm,"),
                    HasSubstr(",estimate_velocity_sd_z_mm_s,"),
                    HasSubstr(",estimate_velocity_x_provenance,")));
  EXPECT_THAT(wide, AllOf(HasSubstr(",assumed"), HasSubstr(",measured")));
  write_export(export_opensim, data, folder / "jaw.sto");
  EXPECT_THAT(read_file(folder / "jaw.sto"), HasSubstr("\testimate_velocity_x_provenance\t"));
  const Exported trc = write_export(export_trc, data, folder / "jaw.trc");
  EXPECT_THAT(read_points(folder / "jaw.trc").names, testing::ElementsAre("jaw", "estimate"));
  EXPECT_THAT(trc.notes, Contains(HasSubstr("estimate (velocity)")));
}

TEST(ComputedExport, ResampledEstimatesStandAtTheResampledTimes) {
  const TemporaryFolder folder;
  const ExportData data = with_estimates(point_file(folder), 40);
  const ExportSeries& velocity = series_of(data, "estimate", "velocity");
  std::size_t there = 0;
  for (std::size_t k = 0; k < data.samples(); ++k) there += velocity.is_there(k) ? 1U : 0U;
  EXPECT_GT(there, data.samples() * 9 / 10);
}

// Three points of a jaw that rests, then turns by `angle` about an axis through `centre`.
constexpr double kRest_s = 1;
Eigen::Isometry3d motion_at(double time_s) {
  const double angle = time_s < kRest_s ? 0 : 0.2 * (1 - std::cos(2 * (time_s - kRest_s)));
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d(0, 1, 0)).toRotationMatrix();
  motion.translation() = Eigen::Vector3d(0.01 * std::sin(angle), 0, 0);
  return motion;
}

const Eigen::Vector3d kBody_m[] = {{0.1, 0.02, -0.04}, {0.1, -0.02, -0.04}, {0.12, 0, -0.06}};
const Eigen::Vector3d kIncisor_m(0.095, 0.001, -0.045), kCondyle_m(0.002, 0.05, 0.001);

std::string three_points(const TemporaryFolder& folder) {
  std::string text = "time_s";
  for (const char* point : {"a", "b", "c"})
    text += fmt::format(",{0}_x_mm,{0}_y_mm,{0}_z_mm", point);
  for (int k = 0; k < 400; ++k) {
    text += fmt::format("\n{:.2f}", k * 0.01);
    for (const Eigen::Vector3d& at_rest : kBody_m) {
      const Eigen::Vector3d place_mm = motion_at(k * 0.01) * at_rest * 1e3;
      text += fmt::format(",{:.6f},{:.6f},{:.6f}", place_mm.x(), place_mm.y(), place_mm.z());
    }
  }
  return folder.write("body.csv", text + "\n");
}

std::string landmarks(const TemporaryFolder& folder) {
  const auto mm = [](const Eigen::Vector3d& m) {
    return fmt::format("[{}, {}, {}]", m.x() * 1e3, m.y() * 1e3, m.z() * 1e3);
  };
  return folder.write(
      "jaw.landmarks.toml",
      fmt::format("[landmarks]\ncondyle_left = {}\ncondyle_right = [2, -50, 1]\n"
                  "incisor_lower = {}\nplane_left = [10, 60, 20]\nplane_right = [10, -60, 20]\n"
                  "plane_front = [90, 0, 22]\ncondyle_sd_mm = 2\nincisor_sd_mm = 0.5\n"
                  "plane_sd_mm = 1\n",
                  mm(kCondyle_m), mm(kIncisor_m)));
}

TEST(ComputedExport, LandmarksAndPoseMoveWithTheJaw) {
  const TemporaryFolder folder;
  ExportData data = read_export_data(three_points(folder), {}, never);
  add_landmark_series({.file = landmarks(folder), .reference_s = {{0, 0.9}}}, {}, data);
  // The pose that MCAP holds is of the measured points, not of all.
  write_export(export_mcap, data, folder / "jaw.mcap");
  EXPECT_EQ(read_points(folder / "jaw.mcap").names.size(), 6U);
  add_pose_series(data);
  const ExportSeries& incisor = series_of(data, "incisor_lower", "position");
  const ExportSeries& condyle = series_of(data, "condyle_left", "position");
  const ExportSeries& turn = series_of(data, "jaw", "orientation");
  EXPECT_EQ(incisor.provenance, Provenance::derived);
  EXPECT_THAT(incisor.assumption, HasSubstr("known to 0.5 mm"));
  const double* const first = turn.at(0);
  const Eigen::Quaterniond at_rest(first[0], first[1], first[2], first[3]);
  for (std::size_t k = 0; k < data.samples(); ++k) {
    const Eigen::Isometry3d motion = motion_at(static_cast<double>(k) * 0.01);
    const Eigen::Vector3d incisor_m = motion * kIncisor_m, condyle_m = motion * kCondyle_m;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(incisor.at(k)[axis], incisor_m[axis], 1e-7);
      EXPECT_NEAR(condyle.at(k)[axis], condyle_m[axis], 1e-7);
    }
    const double* const q = turn.at(k);
    const Eigen::Quaterniond turned(q[0], q[1], q[2], q[3]);
    EXPECT_LT((turned * at_rest.inverse()).angularDistance(Eigen::Quaterniond(motion.linear())),
              1e-5);
  }
  write_export(export_c3d, data, folder / "jaw.c3d");
  const ReadPoints read = read_points(folder / "jaw.c3d");
  EXPECT_THAT(read.names, testing::ElementsAre("a", "b", "c", "condyle_left", "condyle_right",
                                               "incisor_lower", "jaw"));
  const auto turns = open_analog(folder / "jaw.c3d", {"jaw_orientation_w"}, FaultPolicy::event);
  ASSERT_TRUE(turns->next());
  EXPECT_NEAR(turns->values()[0], first[0], kFloat);
}

TEST(ComputedExport, PoseAndLandmarksNeedThreePoints) {
  const TemporaryFolder folder;
  ExportData data = read_export_data(point_file(folder), {}, never);
  try {
    add_pose_series(data);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("has no pose of the jaw"), HasSubstr("--marker A")));
  }
  EXPECT_THROW(add_landmark_series({.file = landmarks(folder), .reference_s = {}}, {}, data),
               InputError);
}

}  // namespace
}  // namespace condyle::host
