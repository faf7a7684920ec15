// SPDX-License-Identifier: Apache-2.0
// What is exported is read back without a difference beyond the rounding of the format.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "exports/even_times.h"
#include "hosted/files/input_error.h"
#include "recordings/analog_channels.h"
#include "support/export_content.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::number_between;
using testing_support::random_points;
using testing_support::read_file;
using testing_support::read_points;
using testing_support::ReadPoints;
using testing_support::TemporaryFolder;
using testing_support::write_export;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// The same names, and in each frame the same places to within `rounding` of their size; frames
// without a sample hold nothing.
void expect_same(const ReadPoints& read, const ExportData& data, double rate_Hz, double rounding) {
  const auto points = data.points();
  RC_ASSERT(read.names.size() == points.size());
  std::size_t k = 0;
  for (std::size_t frame = 0; frame < read.time_ns.size(); ++frame) {
    RC_ASSERT(std::abs(read.time_ns[frame] - nanoseconds(static_cast<double>(frame) / rate_Hz)) <=
              1);
    const bool has_sample = std::abs(read.time_ns[frame] - data.time_ns[k]) <= 1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      RC_ASSERT(read.names[i] == points[i]->name);
      const Eigen::Vector3d place_m = read.points_m[frame].col(static_cast<Eigen::Index>(i));
      const bool is_there = has_sample && points[i]->is_there(k);
      RC_ASSERT(place_m.allFinite() == is_there);
      for (std::size_t axis = 0; is_there && axis < 3; ++axis) {
        const double expected_m = points[i]->at(k)[axis];
        RC_ASSERT(std::abs(place_m[static_cast<Eigen::Index>(axis)] - expected_m) <=
                  rounding * std::abs(expected_m));
      }
    }
    if (has_sample) ++k;
  }
  RC_ASSERT(k == data.samples());
}

struct RoundTrip {
  Exporter write;
  const char* name;
  double rounding;  // relative
};
constexpr double kFloat = 0x1p-24, kDouble = 0x1p-52;
constexpr RoundTrip kAtOneRate[] = {{export_c3d, "jaw.c3d", kFloat},
                                    {export_trc, "jaw.trc", kDouble}};

RC_GTEST_PROP(Export, IsReadBackAtOneRate, ()) {
  for (const RoundTrip& format : kAtOneRate) {
    const TemporaryFolder folder;
    const double rate_Hz = *rc::gen::inRange(2, 2000) / 2.0;
    const ExportData data = random_points(rate_Hz, true);
    const bool in_metres = *rc::gen::inRange(0, 2) == 0;
    write_export(format.write, data, folder / format.name, {.states_unit = in_metres});
    const ReadPoints read = read_points(folder / format.name);
    RC_ASSERT(read.info.stated.unit == (in_metres ? "m" : "mm"));
    RC_ASSERT(std::abs(*read.info.stated.rate_Hz - rate_Hz) <= kFloat * rate_Hz);
    expect_same(read, data, rate_Hz, format.rounding);
  }
}

// The time of each sample is kept.
void expect_same_samples(const std::string& path, const ExportData& data, const TableForm& form) {
  const ReadPoints read = read_points(path);
  RC_ASSERT(read.time_ns == data.time_ns);
  RC_ASSERT(read.info.stated.unit == (form.states_unit ? "m" : "mm"));
  const auto points = data.points();
  RC_ASSERT(read.names.size() == points.size());
  for (std::size_t k = 0; k < data.samples(); ++k) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d place_m = read.points_m[k].col(static_cast<Eigen::Index>(i));
      RC_ASSERT(place_m.allFinite() == points[i]->is_there(k));
      for (std::size_t axis = 0; points[i]->is_there(k) && axis < 3; ++axis) {
        RC_ASSERT(std::abs(place_m[static_cast<Eigen::Index>(axis)] - points[i]->at(k)[axis]) <=
                  kDouble * std::abs(points[i]->at(k)[axis]));
      }
    }
  }
}

RC_GTEST_PROP(Export, WideCsvIsReadBackInEveryForm, ()) {
  const TemporaryFolder folder;
  const double rate_Hz = *rc::gen::inRange(20, 500);
  const ExportData data = random_points(rate_Hz, true);
  const TableForm form{.has_decimal_comma = *rc::gen::inRange(0, 2) == 0,
                       .states_unit = *rc::gen::inRange(0, 2) == 0};
  write_export(export_wide_csv, data, folder / "jaw.csv", form);
  expect_same_samples(folder / "jaw.csv", data, form);
}

#ifdef CONDYLE_HAS_MATIO
RC_GTEST_PROP(Export, MatIsReadBack, ()) {
  const TemporaryFolder folder;
  const ExportData data = random_points(*rc::gen::inRange(20, 500), true);
  // A square matrix does not tell rows from columns.
  RC_PRE(data.samples() > 3 * data.points().size());
  const TableForm form{.states_unit = *rc::gen::inRange(0, 2) == 0};
  write_export(export_mat, data, folder / "jaw.mat", form);
  expect_same_samples(folder / "jaw.mat", data, form);
}
#endif

ExportData two_points() {
  ExportData data;
  data.source = "recording";
  for (const char* name : {"jaw", "head"}) {
    data.series.push_back({.name = name,
                           .quantity = "position",
                           .components = {"x", "y", "z"},
                           .unit = "m",
                           .values = {}});
  }
  for (int k = 0; k < 10; ++k) {
    data.time_ns.push_back(nanoseconds(1.5 + k / 100.0));
    for (ExportSeries& series : data.series) {
      for (const double value : {0.001 * k, -0.002, 0.3}) series.values.push_back(value);
    }
  }
  return data;
}

TEST(Export, C3dKeepsDriveChannelsAndEvents) {
  ExportData data = two_points();
  data.series.push_back(
      {.name = "drive", .quantity = "force", .components = {""}, .unit = "N", .values = {}});
  for (int k = 0; k < 10; ++k) data.series.back().values.push_back(k == 4 ? kMissing : 0.5 * k);
  data.channels.push_back(
      {.channel = {.name = "masseter", .unit = "V", .rate_Hz = 300}, .first_s = 1.5, .values = {}});
  for (int k = 0; k < 30; ++k) data.channels.back().values.push_back(0.25 * k);
  data.channels.push_back(
      {.channel = {.name = "odd", .unit = "V", .rate_Hz = 250}, .first_s = 1.5, .values = {1, 2}});
  data.events = {{1.5, "begin"}, {1.55, "Left swallow"}, {70, "late"}};
  const TemporaryFolder folder;
  const Exported exported = write_export(export_c3d, data, folder / "jaw.c3d");
  EXPECT_THAT(exported.notes, AllOf(Contains(HasSubstr("1 analogue channels are left out")),
                                    Contains(HasSubstr("times begin at 0, which is 1.5"))));
  const ReadPoints read = read_points(folder / "jaw.c3d");
  ASSERT_EQ(read.info.stated.events.size(), 3U);
  EXPECT_EQ(read.info.stated.events[1].name, "Left swallow");
  EXPECT_NEAR(read.info.stated.events[1].time_s, 0.05, 1e-8);
  EXPECT_NEAR(read.info.stated.events[2].time_s, 68.5, 1e-6);
  ASSERT_EQ(read.info.stated.channels.size(), 2U);
  EXPECT_EQ(read.info.stated.channels[0].unit, "N");
  const auto reader = open_analog(folder / "jaw.c3d", {"drive", "masseter"}, FaultPolicy::event);
  for (int k = 0; k < 30; ++k) {
    ASSERT_TRUE(reader->next());
    EXPECT_EQ(reader->values()[1], 0.25 * k);
    const bool has_drive = k % 3 == 0 && k != 12;
    EXPECT_EQ(std::isfinite(reader->values()[0]), has_drive);
    if (has_drive) {
      EXPECT_EQ(reader->values()[0], 0.5 * (k / 3));
    }
  }
}

// The layout that the C3D user guide prescribes, byte by byte.
TEST(Export, C3dHasThePrescribedBytes) {
  ExportData data;
  data.source = "recording";
  data.series.push_back({.name = "J",
                         .quantity = "position",
                         .components = {"x", "y", "z"},
                         .unit = "m",
                         .values = {0.032, 0, -0.001, kMissing, kMissing, kMissing}});
  data.time_ns = {0, 10'000'000};
  const TemporaryFolder folder;
  write_export(export_c3d, data, folder / "jaw.c3d");
  const std::string bytes = read_file(folder / "jaw.c3d");
  ASSERT_EQ(bytes.size() % 512, 0U);
  const std::string header{2, 0x50, 1, 0, 0, 0, 1, 0, 2, 0, 0, 0};
  EXPECT_EQ(bytes.substr(0, header.size()), header);
  EXPECT_EQ(bytes.substr(12, 4), std::string({0x6f, 0x12, '\x83', '\xba'}));  // -32 / 32000
  const std::string block = bytes.substr(16, 2);
  EXPECT_EQ(block, std::string({3, 0}));
  EXPECT_EQ(bytes.substr(18, 2), std::string({0, 0}));
  EXPECT_EQ(bytes.substr(20, 4), std::string({0, 0, '\xc8', 0x42}));  // 100
  EXPECT_EQ(bytes.substr(512, 4), std::string({1, 0x50, 1, 84}));
  const std::string group{5, '\xff', 'P', 'O', 'I', 'N', 'T', 3, 0, 0};
  EXPECT_EQ(bytes.substr(516, group.size()), group);
  const std::string used{4, 1, 'U', 'S', 'E', 'D', 7, 0, 2, 0, 1, 0, 0};
  EXPECT_EQ(bytes.substr(526, used.size()), used);
  const std::string frames{0, 0, 0, 0x42, 0, 0, 0, 0, 0, 0, '\x80', '\xbf', 0, 0, 0,      0,
                           0, 0, 0, 0,    0, 0, 0, 0, 0, 0, 0,      0,      0, 0, '\x80', '\xbf'};
  EXPECT_EQ(bytes.substr(1024, frames.size()), frames);
}

TEST(Export, C3dStatesManyFramesInParameters) {
  ExportData data;
  data.source = "recording";
  data.series.push_back({.name = "J",
                         .quantity = "position",
                         .components = {"x", "y", "z"},
                         .unit = "m",
                         .values = std::vector<double>(3 * 70'000, 0.1)});
  for (int k = 0; k < 70'000; ++k) data.time_ns.push_back(nanoseconds(k / 1000.0));
  const TemporaryFolder folder;
  write_export(export_c3d, data, folder / "jaw.c3d");
  const ReadPoints read = read_points(folder / "jaw.c3d");
  EXPECT_EQ(read.time_ns.size(), 70'000U);
  EXPECT_EQ(read.info.stated.frames, 70'000U);
}

TEST(Export, TrcHasTheHeaderThatOpenSimRequires) {
  ExportData data = two_points();
  data.series[1].values[4] = kMissing;
  const TemporaryFolder folder;
  write_export(export_trc, data, folder / "jaw.trc");
  EXPECT_THAT(
      read_file(folder / "jaw.trc"),
      testing::StartsWith("PathFileType\t4\t(X/Y/Z)\tjaw.trc\n"
                          "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\t"
                          "OrigDataStartFrame\tOrigNumFrames\n"
                          "100\t100\t10\t2\tmm\t100\t1\t10\n"
                          "Frame#\tTime\tjaw\t\t\thead\t\t\n"
                          "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n"
                          "\n"
                          "1\t1.5\t0\t-2\t300\t0\t-2\t300\n"
                          "2\t1.51\t1\t-2\t300\tNaN\tNaN\tNaN\n"));
}

// One sample of a point, a pose, a drive and a channel, the second sample missing.
ExportData of_every_kind() {
  ExportData data;
  data.source = "recording";
  data.time_ns = {0, 10'000'000};
  data.series = {{.name = "left, upper",
                  .quantity = "position",
                  .components = {"x", "y", "z"},
                  .unit = "m",
                  .values = {0.0015, 0, 2, kMissing, kMissing, kMissing}},
                 {.name = "jaw",
                  .quantity = "orientation",
                  .components = {"w", "x", "y", "z"},
                  .provenance = Provenance::derived,
                  .values = {1, 0, 0, 0, 0.5, 0.5, 0.5, 0.5}},
                 {.name = "drive",
                  .quantity = "force",
                  .components = {""},
                  .unit = "N",
                  .values = {2.5, kMissing}}};
  data.channels.push_back(
      {.channel = {.name = "emg", .unit = "mV", .rate_Hz = 1000}, .first_s = 0, .values = {0.25}});
  data.events = {{0.005, "swallow"}};
  return data;
}

TEST(Export, LongCsvStatesUnitAndProvenanceOfEachValue) {
  const TemporaryFolder folder;
  write_export(export_long_csv, of_every_kind(), folder / "jaw.csv");
  EXPECT_EQ(read_file(folder / "jaw.csv"),
            "time_s,name,quantity,component,value,unit,provenance\n"
            "0,\"left, upper\",position,x,1.5,mm,measured\n"
            "0,\"left, upper\",position,y,0,mm,measured\n"
            "0,\"left, upper\",position,z,2000,mm,measured\n"
            "0,jaw,orientation,w,1,,derived\n"
            "0,jaw,orientation,x,0,,derived\n"
            "0,jaw,orientation,y,0,,derived\n"
            "0,jaw,orientation,z,0,,derived\n"
            "0,drive,force,,2.5,N,measured\n"
            "0.01,\"left, upper\",position,x,,mm,missing\n"
            "0.01,\"left, upper\",position,y,,mm,missing\n"
            "0.01,\"left, upper\",position,z,,mm,missing\n"
            "0.01,jaw,orientation,w,0.5,,derived\n"
            "0.01,jaw,orientation,x,0.5,,derived\n"
            "0.01,jaw,orientation,y,0.5,,derived\n"
            "0.01,jaw,orientation,z,0.5,,derived\n"
            "0.01,drive,force,,,N,missing\n"
            "0,emg,analogue,,0.25,mV,measured\n");
  EXPECT_EQ(read_file(folder / "jaw.events.csv"), "time_s,name\n0.005,swallow\n");
}

TEST(Export, WritesDecimalCommasAndSemicolons) {
  const TemporaryFolder folder;
  const Exported exported = write_export(export_wide_csv, of_every_kind(), folder / "jaw.csv",
                                         {.has_decimal_comma = true});
  EXPECT_EQ(read_file(folder / "jaw.csv"),
            "time_s;\"left, upper_x_mm\";\"left, upper_y_mm\";\"left, upper_z_mm\";"
            "jaw_qw;jaw_qx;jaw_qy;jaw_qz;drive_N\n"
            "0;1,5;0;2000;1;0;0;0;2,5\n"
            "0,01;;;;0,5;0,5;0,5;0,5;\n");
  EXPECT_EQ(read_file(folder / "jaw.events.csv"), "time_s;name\n0,005;swallow\n");
  EXPECT_THAT(exported.notes, AllOf(Contains(HasSubstr("no place for provenance")),
                                    Contains(HasSubstr("1 analogue channel"))));
}

// The turn by 120 degrees about the diagonal takes x to y, y to z, z to x.
TEST(Export, OpenSimTablesHoldMetresAndDegrees) {
  const TemporaryFolder folder;
  const Exported exported = write_export(export_opensim, of_every_kind(), folder / "jaw.mot");
  const std::string text = read_file(folder / "jaw.mot");
  EXPECT_THAT(text, testing::StartsWith(
                        "jaw.mot\nversion=1\nnRows=2\nnColumns=8\ninDegrees=yes\nendheader\n"
                        "time\tleft,_upper_x\tleft,_upper_y\tleft,_upper_z\tjaw_rx\tjaw_ry\t"
                        "jaw_rz\tdrive\n0\t0.0015\t0\t2\t"));
  double rx = 0, ry = 0, rz = 0;
  ASSERT_EQ(std::sscanf(text.substr(text.find("\n0.01\t")).c_str(),
                        "\n0.01\tNaN\tNaN\tNaN\t%lf\t%lf\t%lf\tNaN", &rx, &ry, &rz),
            3);
  // Rx(90) Ry(90) Rz(0): the middle angle is at its limit, where only rx + rz is determined.
  EXPECT_NEAR(ry, 90, 1e-5);
  EXPECT_NEAR(rx + rz, 90, 1e-5);
  EXPECT_THAT(exported.notes, ElementsAre(HasSubstr("1 analogue channel")));
}

TEST(Export, RefusesTimesThatFollowNoRate) {
  ExportData data = two_points();
  data.time_ns[3] += 4'000'000;
  const TemporaryFolder folder;
  try {
    export_c3d(data, {}, folder / "jaw.c3d");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("do not follow one rate"), HasSubstr("give --resample-Hz R")));
  }
  resample(data, 100);  // the remedy
  export_c3d(data, {}, folder / "jaw.c3d");
}

TEST(Export, FindsTheRoundRateOfRoundedTimes) {
  ExportData data = two_points();
  for (ExportSeries& series : data.series) series.values.assign(3 * 2000, 0.1);
  data.time_ns.clear();
  for (int k = 0; k < 2000; ++k) {
    data.time_ns.push_back(nanoseconds(std::round(k / 60.0 * 1e3) * 1e-3));  // milliseconds
  }
  const EvenTimes even = even_times(data);
  EXPECT_EQ(even.rate_Hz, 60);
  EXPECT_EQ(even.frames, 2000U);
  EXPECT_LE(even.largest_shift_s, 0.51e-3);
}

// Straight lines are kept, and nothing stands where a neighbour is missing or far.
RC_GTEST_PROP(Export, ResamplesWithinStraightLinesOnly, ()) {
  ExportData data;
  data.source = "recording";
  data.series.push_back(
      {.name = "jaw", .quantity = "position", .components = {""}, .unit = "m", .values = {}});
  const double slope = *number_between(-1, 1);
  std::vector<bool> is_there;
  for (int k = 0; k < 100; ++k) {
    if (k > 40 && k < 45) continue;  // a gap
    data.time_ns.push_back(nanoseconds(k / 100.0));
    is_there.push_back(k == 0 || *rc::gen::inRange(0, 5) > 0);
    data.series[0].values.push_back(is_there.back() ? slope * k / 100.0 : kMissing);
  }
  const ExportData before = data;
  const double rate_Hz = *number_between(20.5, 500);
  resample(data, rate_Hz);
  RC_ASSERT(data.samples() == static_cast<std::size_t>(std::floor(0.99 * rate_Hz)) + 1);
  for (std::size_t n = 0; n < data.samples(); ++n) {
    const TimeNs time_ns = data.time_ns[n];
    const auto after = std::lower_bound(before.time_ns.begin(), before.time_ns.end(), time_ns);
    const auto k = static_cast<std::size_t>(after - before.time_ns.begin());
    const double value = data.series[0].values[n];
    if (k == before.samples() || before.time_ns[k] - time_ns <= 1 ||
        (k > 0 && time_ns - before.time_ns[k - 1] <= 1)) {
      continue;  // a sample's own time
    }
    const bool known = is_there[k] && is_there[k - 1] &&
                       before.time_ns[k] - before.time_ns[k - 1] < nanoseconds(0.015);
    RC_ASSERT(std::isfinite(value) == known);
    if (known) RC_ASSERT(std::abs(value - slope * seconds(time_ns)) <= 1e-9);
  }
  RC_ASSERT(data.series[0].provenance == Provenance::derived);
}

TEST(Export, GivesDistinctNamesAndCountsWhatIsLeftOut) {
  const TemporaryFolder folder;
  const std::string path = folder.write("jaw.csv",
                                        "time_s,p1_x_mm,p1_y_mm,p1_z_mm\n"
                                        "0,1,2,3\n0.01,1,2,4\n0.005,1,2,5\n,1,2,5\n0.02,,,\n");
  const RecordingOptions options{.faults = FaultPolicy::event};
  const ExportData data = read_export_data(path, options, [](double) { return false; });
  EXPECT_EQ(data.samples(), 3U);
  EXPECT_FALSE(data.series[0].is_there(2));
  EXPECT_THAT(data.notes, ElementsAre(HasSubstr("1 sample is left out: without a time"),
                                      HasSubstr("1 sample is left out: not later")));
}

}  // namespace
}  // namespace condyle::host
