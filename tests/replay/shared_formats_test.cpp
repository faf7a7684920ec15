// SPDX-License-Identifier: Apache-2.0
// Text formats with files of their makers. They are not part of the project: without
// CONDYLE_REFERENCE_DATA these tests skip.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "recordings/named_points.h"
#include "support/command.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::reference_data;
using testing_support::run_condyle;

class SharedFormats : public testing::Test {
 protected:
  void SetUp() override {
    if (reference_data("formats/expected.json").empty()) {
      GTEST_SKIP() << "set CONDYLE_REFERENCE_DATA to the folder of reference data";
    }
  }
};

struct Held {
  std::vector<std::string> names;
  std::size_t frames = 0, missing = 0;
  host::RecordingInfo info;
};

Held held_by(const std::string& name, const host::RecordingOptions& options = {}) {
  const auto recording = host::open_to_describe(reference_data("formats/" + name), options);
  auto* const named = dynamic_cast<host::NamedPointsRecording*>(recording.get());
  Held held;
  Sample sample;
  while (recording->next(sample)) {
    ++held.frames;
    for (Eigen::Index i = 0; named != nullptr && i < named->points_m().cols(); ++i) {
      if (!named->points_m().col(i).allFinite()) ++held.missing;
    }
  }
  if (named != nullptr) held.names = named->names();
  held.info = recording->info();
  return held;
}

TEST_F(SharedFormats, TrcFilesHoldWhatAnIndependentReaderFinds) {
  std::ifstream file(reference_data("formats/expected.json"));
  const auto expected = nlohmann::json::parse(file);
  int files = 0;
  for (const auto& [name, values] : expected.items()) {
    if (!name.ends_with(".trc")) continue;
    ++files;
    const Held held = held_by(name);
    EXPECT_EQ(held.frames, values["frames"].get<std::size_t>()) << name;
    EXPECT_EQ(held.names.size(), values["markers"].get<std::size_t>()) << name;
    EXPECT_EQ(held.info.stated.unit, values["unit"].get<std::string>()) << name;
    ASSERT_TRUE(held.info.stated.rate_Hz) << name;
    EXPECT_DOUBLE_EQ(*held.info.stated.rate_Hz, values["rate_Hz"].get<double>()) << name;
    for (std::size_t i = 0; i < values["first_markers"].size(); ++i) {
      EXPECT_EQ(held.names.at(i), values["first_markers"][i].get<std::string>()) << name;
    }
  }
  EXPECT_EQ(files, 5);
}

TEST_F(SharedFormats, OneTrialIsAlikeWithAndWithoutItsHeader) {
  const Held with = held_by("pyomeca/markers.csv");
  const Held without =
      held_by("pyomeca/markers_without_header.csv", {.rate_Hz = 100, .units_per_metre = 1000});
  EXPECT_EQ(with.info.format, "Vicon CSV");
  EXPECT_EQ(with.frames, 580U);
  EXPECT_EQ(with.names.size(), 51U);
  EXPECT_EQ(without.frames, 580U);
  EXPECT_EQ(without.names.size(), 51U);
  EXPECT_EQ(with.missing, without.missing);
}

TEST_F(SharedFormats, CarstensPositions) {
  const Held held = held_by("ag501/0021.pos");
  EXPECT_EQ(held.frames, 5021U);
  EXPECT_EQ(held.names.size(), 16U);
  EXPECT_EQ(held.missing, 8U * 5021U) << "eight channels were not used";
}

TEST_F(SharedFormats, OpenSimFilesAreRefusedByName) {
  for (const char* const name : {"pyomeca/inverse_kin.mot", "pyomeca/inverse_dyn.sto"}) {
    const auto result = run_condyle({"replay", reference_data(std::string("formats/") + name)});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.errors, AllOf(HasSubstr("OpenSim MOT or STO"), HasSubstr("TRC or C3D")));
  }
}

TEST_F(SharedFormats, OneMarkerIsReplayed) {
  const testing_support::TemporaryFolder folder;
  const std::string path = reference_data("formats/bmc/walk.trc");
  const auto none = run_condyle({"replay", path});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.errors, AllOf(HasSubstr("has 55 markers"), HasSubstr("--marker NAME")));
  const auto one =
      run_condyle({"replay", path, "--marker", "R.Heel", "--out", folder / "estimates.csv"});
  EXPECT_EQ(one.exit_code, 0) << one.errors;
}

// Whatever moves: a walk or a sprint of 9 m as well.
TEST_F(SharedFormats, RealMotionIsReplayed) {
  const testing_support::TemporaryFolder folder;
  int files = 0;
  for (const auto& file : std::filesystem::directory_iterator(reference_data("motion/open"))) {
    const auto result = run_condyle({"replay", file.path().string(), "--axis", "x", "--faults",
                                     "event", "--out", folder / "estimates.csv"});
    EXPECT_EQ(result.exit_code, 0) << file.path() << ": " << result.errors;
    ++files;
  }
  EXPECT_EQ(files, 35);
}

}  // namespace
}  // namespace condyle
