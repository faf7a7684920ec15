// SPDX-License-Identifier: Apache-2.0
// Exported MCAP files are read back bit for bit.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "hosted/files/input_error.h"
#include "support/export_content.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;
using testing_support::number_between;
using testing_support::random_points;
using testing_support::read_points;
using testing_support::ReadPoints;
using testing_support::TemporaryFolder;
using testing_support::write_export;

bool is_same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || a == b;
}

RC_GTEST_PROP(McapExport, GivesThePointsBack, ()) {
  const TemporaryFolder folder;
  ExportData data = random_points(*number_between(1, 1000), true);
  // Also times that a stamp of ROS cannot hold.
  const TimeNs begin_ns = *rc::gen::element<TimeNs>(0, 1, -1'500'000'001, 1'700'000'000'123'456'789,
                                                    4'000'000'000'000'000'000);
  for (TimeNs& time_ns : data.time_ns) time_ns += begin_ns;
  data.series[0].name = "Marker 1:lower \xc3\xa4";
  const bool has_drive = *rc::gen::arbitrary<bool>();
  if (has_drive) {
    data.series.push_back(
        {.name = "drive", .quantity = "force", .components = {""}, .unit = "N", .values = {}});
    for (std::size_t k = 0; k < data.samples(); ++k) {
      data.series.back().values.push_back(*number_between(-5, 5));
    }
  }
  data.events = {{seconds(data.time_ns.back()), "clench"}};
  write_export(export_mcap, data, folder / "x.mcap");
  const ReadPoints read = read_points(folder / "x.mcap");
  RC_ASSERT(read.time_ns == data.time_ns);
  RC_ASSERT(read.info.has_drive == has_drive);
  RC_ASSERT(*read.info.stated.frames == data.samples());
  RC_ASSERT(read.info.stated.events.size() == 1U);
  RC_ASSERT(read.info.stated.events[0].name == "clench");
  const auto points = data.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    RC_ASSERT(read.names[i] == points[i]->name);
    for (std::size_t k = 0; k < data.samples(); ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        RC_ASSERT(
            is_same(read.points_m[k](static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i)),
                    points[i]->at(k)[axis]));
      }
    }
  }
}

// One axis with a drive, and poses, of which some are missing.
RC_GTEST_PROP(McapExport, GivesAnAxisOrPosesBack, ()) {
  const bool is_pose = *rc::gen::arbitrary<bool>();
  ExportData data;
  data.source = "recording";
  const auto add = [&](const char* name, const char* quantity,
                       std::vector<std::string> components) {
    data.series.push_back({.name = name,
                           .quantity = quantity,
                           .components = std::move(components),
                           .unit = "",
                           .values = {}});
  };
  if (is_pose) {
    add("jaw", "position", {"x", "y", "z"});
    add("jaw", "orientation", {"w", "x", "y", "z"});
  } else {
    add("position", "position", {""});
    add("drive", "force", {""});
  }
  const int samples = *rc::gen::inRange(1, 50);
  std::vector<bool> is_there;
  for (int k = 0; k < samples; ++k) {
    data.time_ns.push_back(k * 10'000'000);
    is_there.push_back(*rc::gen::inRange(0, 5) > 0);
    for (ExportSeries& series : data.series) {
      for (std::size_t i = 0; i < series.components.size(); ++i) {
        series.values.push_back(is_there.back() ? *number_between(-0.5, 0.5) : std::nan(""));
      }
    }
  }
  const TemporaryFolder folder;
  write_export(export_mcap, data, folder / "x.mcap");
  const auto recording = open_recording(folder / "x.mcap", {});
  RC_ASSERT(recording->info().kind == (is_pose ? SampleKind::pose : SampleKind::one_axis));
  RC_ASSERT(recording->info().has_drive == !is_pose);
  Sample sample;
  for (std::size_t k = 0; k < data.samples(); ++k) {
    RC_ASSERT(recording->next(sample));
    RC_ASSERT(sample.time_ns == data.time_ns[k]);
    RC_ASSERT(sample.position_valid == is_there[k]);
    if (!is_there[k]) continue;
    std::vector<double> expected(data.series[0].at(k),
                                 data.series[0].at(k) + data.series[0].components.size());
    if (is_pose) {
      expected.insert(expected.end(), data.series[1].at(k), data.series[1].at(k) + 4);
    } else {
      RC_ASSERT(sample.drive_N == data.series[1].at(k)[0]);
    }
    RC_ASSERT(std::equal(expected.begin(), expected.end(), sample.coordinates));
  }
  RC_ASSERT(!recording->next(sample));
}

// A changed bit anywhere is noticed, or changes nothing.
TEST(McapExport, DamageIsAnErrorThatNamesTheFile) {
  const TemporaryFolder folder;
  ExportData data;
  data.source = "recording";
  data.series.push_back({.name = "p1",
                         .quantity = "position",
                         .components = {"x", "y", "z"},
                         .unit = "m",
                         .values = {}});
  for (int k = 0; k < 20; ++k) {
    data.time_ns.push_back(k * 10'000'000);
    for (int i = 0; i < 3; ++i) data.series[0].values.push_back(0.001 * k);
  }
  write_export(export_mcap, data, folder / "x.mcap");
  const std::string whole = testing_support::read_file(folder / "x.mcap");
  for (std::size_t size : {whole.size() / 2, whole.size() - 1}) {
    const std::string path = folder.write("cut.mcap", whole.substr(0, size));
    try {
      read_points(path);
      FAIL() << size;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("cut.mcap"));
    }
  }
  EXPECT_THROW(write_export(export_mcap, data, folder / "y.mcap", {.is_in_mm = true}), InputError);
}

}  // namespace
}  // namespace condyle::host
