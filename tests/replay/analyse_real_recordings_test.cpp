// SPDX-License-Identifier: Apache-2.0
// `condyle analyse` of real recordings, and of a chew that others simulated.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "replay/analysed_readings.h"
#include "support/command.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing_support::Readings;
using testing_support::reference_data;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

class AnalyseRealRecordings : public testing::Test {
 protected:
  void SetUp() override {
    if (reference_data("zebris_jma/marker1.txt").empty()) {
      GTEST_SKIP() << "set CONDYLE_REFERENCE_DATA to the folder of reference data";
    }
  }
  static Readings analyse(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "analyse");
    arguments.emplace_back("--json");
    const auto result = run_condyle(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return Readings(result.output);
  }
};

// readings.md of the reference data: 5.03 degrees, 8.1 mm of point 1, two bursts of five samples.
TEST_F(AnalyseRealRecordings, LateralExcursion) {
  const Readings readings = analyse({reference_data("zebris_jma/marker1.txt") + "+" +
                                     reference_data("zebris_jma/marker2.txt") + "+" +
                                     reference_data("zebris_jma/marker3.txt")});
  EXPECT_NEAR(readings.value("", "rotation_deg").at("value"), 5.03, 0.03);
  EXPECT_NEAR(readings.value("", "displacement_mm").at("value"), 8.1, 0.06);
  EXPECT_EQ(readings.recording().at("samples_not_used"), 10);
}

TEST_F(AnalyseRealRecordings, TheConvertedFileIsWithheld) {
  const Readings readings =
      analyse({reference_data("zebris_jma/JMA_position.txt"), "--task", "opening", "1", "9"});
  EXPECT_FALSE(readings.recording().at("usable"));
  EXPECT_TRUE(readings.all_are_withheld());
}

// A chew that others simulated: the inclination from three points is that of the condyles' own
// tracks, in that model's axes (x left, y back, z up).
TEST_F(AnalyseRealRecordings, ThirdPartyChew) {
  const double rest_mm[3][3] = {
      {51.7785, 31.4501, 79.637}, {-51.7785, 31.4501, 79.637}, {0.0194, -46.9584, 41.7642}};
  std::ifstream files[3];
  const char* const names[3] = {"ltmjDisp", "rtmjDisp", "incisorDisp"};
  for (int i = 0; i < 3; ++i) {
    files[i].open(reference_data(std::string("artisynth_chew/") + names[i] + ".raw"));
  }
  std::string csv = "time_s,l_x_mm,l_y_mm,l_z_mm,r_x_mm,r_y_mm,r_z_mm,i_x_mm,i_y_mm,i_z_mm\n";
  double own_deg[2] = {NAN, NAN};  // at 3 mm
  for (int row = 0; row < 990; ++row) {
    std::string line;
    for (int i = 0; i < 3; ++i) {
      double values[4];
      for (double& value : values) files[i] >> value;
      if (i == 0) line += std::to_string(values[0]);
      for (int k = 0; k < 3; ++k) line += "," + std::to_string(rest_mm[i][k] + values[k + 1]);
      if (i < 2 && std::isnan(own_deg[i]) && std::hypot(values[2], values[3]) >= 3) {
        own_deg[i] = std::atan2(-values[3], -values[2]) * 180 / M_PI;
      }
    }
    csv += line + "\n";
  }
  const TemporaryFolder folder;
  const std::string landmarks = folder.write(
      "l.toml",
      "[landmarks]\ncondyle_left = [51.7785, 31.4501, 79.637]\n"
      "condyle_right = [-51.7785, 31.4501, 79.637]\nincisor_lower = [0.0194, -46.9584, 41.7642]\n"
      "plane_left = [51.7785, 31.4501, 79.637]\nplane_right = [-51.7785, 31.4501, 79.637]\n"
      "plane_front = [0, -50, 79.637]\nsd_mm = 0.1\n");
  const Readings readings =
      analyse({folder.write("chew.csv", csv), "--landmarks", landmarks, "--reference-s", "0",
               "0.01", "--task", "opening", "0", "0.99"});
  const char* const sides[2] = {"left", "right"};
  for (int i = 0; i < 2; ++i) {
    const auto reading = readings.value("opening", "condylar_inclination_3mm_deg", sides[i]);
    EXPECT_NEAR(reading.at("value"), own_deg[i], 0.5);
    EXPECT_LE(reading.at("low"), own_deg[i]);
    EXPECT_GE(reading.at("high"), own_deg[i]);
  }
}

}  // namespace
}  // namespace condyle
