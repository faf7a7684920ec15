// SPDX-License-Identifier: Apache-2.0
// Exported XDF files are read back bit for bit.
#include <gmock/gmock.h>

#include <cmath>

#include "support/export_content.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::ElementsAre;
using testing_support::random_points;
using testing_support::read_file;
using testing_support::read_points;
using testing_support::ReadPoints;
using testing_support::TemporaryFolder;
using testing_support::write_export;

RC_GTEST_PROP(XdfExport, GivesThePointsBack, ()) {
  const TemporaryFolder folder;
  ExportData data = random_points(*rc::gen::inRange(20, 500), true);
  data.series[0].name = "upper <left> & \xc3\xa4";
  const bool in_metres = *rc::gen::arbitrary<bool>();
  write_export(export_xdf, data, folder / "jaw.xdf", {.states_unit = in_metres});
  const ReadPoints read = read_points(folder / "jaw.xdf");
  RC_ASSERT(read.time_ns == data.time_ns);
  RC_ASSERT(read.info.stated.unit == (in_metres ? "m" : "mm"));
  const auto points = data.points();
  RC_ASSERT(read.names.size() == points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    RC_ASSERT(read.names[i] == points[i]->name);
    for (std::size_t k = 0; k < data.samples(); ++k) {
      const Eigen::Vector3d place_m = read.points_m[k].col(static_cast<Eigen::Index>(i));
      RC_ASSERT(place_m.allFinite() == points[i]->is_there(k));
      for (std::size_t axis = 0; points[i]->is_there(k) && axis < 3; ++axis) {
        const double expected_m = points[i]->at(k)[axis];
        RC_ASSERT(std::abs(place_m[static_cast<Eigen::Index>(axis)] - expected_m) <=
                  0x1p-52 * std::abs(expected_m));
      }
    }
  }
}

TEST(XdfExport, KeepsDriveEventsAndTimes) {
  ExportData data;
  data.source = "recording";
  data.series.push_back(
      {.name = "position", .quantity = "position", .components = {""}, .unit = "m", .values = {}});
  data.series.push_back(
      {.name = "drive", .quantity = "force", .components = {""}, .unit = "N", .values = {}});
  for (int k = 0; k < 600; ++k) {
    data.time_ns.push_back(nanoseconds(1.5 + k / 100.0));
    data.series[0].values.push_back(0.01 * std::sin(0.1 * k));
    data.series[1].values.push_back(k == 4 ? std::nan("") : 0.5 * k);
  }
  data.channels.push_back({.channel = {.name = "masseter", .unit = "V", .rate_Hz = 300},
                           .first_s = 1.5,
                           .values = {1}});
  data.events = {{1.55, "swallow"}, {1.5, "begin"}};
  const TemporaryFolder folder;
  write_export(export_xdf, data, folder / "jaw.xdf");
  const auto recording = open_to_describe(folder / "jaw.xdf", {});
  Sample sample;
  for (std::size_t k = 0; k < 600; ++k) {
    ASSERT_TRUE(recording->next(sample));
    EXPECT_EQ(sample.time_ns, data.time_ns[k]);
    EXPECT_NEAR(sample.coordinates[0], data.series[0].values[k], 1e-17);
    EXPECT_EQ(sample.drive_valid, k != 4);
    if (k != 4) {
      EXPECT_EQ(sample.drive_N, data.series[1].values[k]);
    }
  }
  EXPECT_FALSE(recording->next(sample));
  const std::vector<NamedInstant> events = recording->info().stated.events;
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].name, "begin");
  EXPECT_EQ(events[1].time_s, 1.55);
}

// The first bytes that the specification prescribes.
TEST(XdfExport, HasThePrescribedBytes) {
  ExportData data;
  data.source = "recording";
  data.time_ns = {500'000'000};
  data.series.push_back({.name = "J",
                         .quantity = "position",
                         .components = {"x", "y", "z"},
                         .unit = "m",
                         .values = {0.001, 0, -0.002}});
  const TemporaryFolder folder;
  write_export(export_xdf, data, folder / "jaw.xdf");
  const std::string bytes = read_file(folder / "jaw.xdf");
  const std::string xml = "<?xml version=\"1.0\"?><info><version>1.0</version></info>";
  const std::string start =
      "XDF:" + std::string{4, static_cast<char>(xml.size() + 2), 0, 0, 0, 1, 0};
  EXPECT_EQ(bytes.substr(0, start.size() + xml.size()), start + xml);
  // One sample: length, tag 3, stream 1, one sample in four bytes, its stamp of eight, 0.5 s; 1 mm.
  const std::string sample{4, 44, 0, 0, 0, 3, 0,      1,      0, 0, 0, 4, 1, 0,    0,      0,     8,
                           0, 0,  0, 0, 0, 0, '\xe0', '\x3f', 0, 0, 0, 0, 0, '\0', '\xf0', '\x3f'};
  EXPECT_NE(bytes.find(sample), std::string::npos);
}

}  // namespace
}  // namespace condyle::host
