// SPDX-License-Identifier: Apache-2.0
// `condyle info`: what a recording holds; and --marker, which chooses from it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/c3d_file.h"
#include "support/command.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::C3dContent;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

class Info : public testing::Test {
 protected:
  Info() {
    C3dContent file;
    file.names = {"chin", "left cheek"};
    file.channels = {"force", "masseter"};
    file.channel_units = {"N", "V"};
    file.channel_scale = file.channel_offset = {1, 0};
    file.samples = 2;
    for (int k = 0; k < 200; ++k) {
      file.frames.push_back({{0.1 * k, -5, 300, k >= 50 && k < 60}, {1, 2, 3}});
      file.analog.push_back({1, 2, 3, 4});
    }
    path_ = folder_.write("jaw.c3d", file.bytes());
  }

  TemporaryFolder folder_;
  std::string path_;
};

TEST_F(Info, ShowsWhatAFileHolds) {
  const auto result = run_condyle({"info", path_, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["format"], "C3D");
  EXPECT_EQ(json["frames"], 200);
  EXPECT_EQ(json["rate_Hz"], 100);
  EXPECT_EQ(json["unit"], "mm");
  EXPECT_EQ(json["markers"], nlohmann::json({"chin", "left cheek"}));
  const auto& chin = json["points"][0];
  EXPECT_EQ(chin["missing"], 10);
  EXPECT_EQ(chin["gaps"], 1);
  EXPECT_EQ(chin["longest_gap"], 10);
  EXPECT_NEAR(chin["range_mm"]["x"][1], 19.9, 1e-4);
  EXPECT_EQ(json["analog"][1]["unit"], "V");
  EXPECT_EQ(json["analog"][1]["rate_Hz"], 200);
  const auto text = run_condyle({"info", path_});
  EXPECT_THAT(text.output, AllOf(HasSubstr("2 markers"),
                                 HasSubstr("missing in 10 of 200 samples, 1 gap, longest 10"),
                                 HasSubstr("force  N, 200 Hz")));
}

TEST_F(Info, ShowsACsvFile) {
  const auto result = run_condyle(
      {"info", folder_.write("axis.csv", "time_s,position_mm\n0,1\n0.01,2\n0.02,\n0.03,4\n"),
       "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["frames"], 4);
  EXPECT_EQ(json["rate_Hz"], 100);
  EXPECT_EQ(json["points"][0]["missing"], 1);
  EXPECT_EQ(json["markers"].size(), 0);
}

// Also the unit that was decided or that the file spells in another way.
TEST_F(Info, NamesTheUnitInWhichItReads) {
  std::string rows;
  for (int k = 0; k < 50; ++k) rows += fmt::format("{},{}\n", k * 0.01, 80 + k % 20);
  for (const auto& [names, unit] :
       {std::pair("time_s,position", "mm"), std::pair("time_s,position (Millimeter)", "mm"),
        std::pair("time_s,position_cm", "cm")}) {
    const std::string path = folder_.write("unit.csv", std::string(names) + "\n" + rows);
    const auto result = run_condyle({"info", path, "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(nlohmann::json::parse(result.output)["unit"], unit) << names;
  }
}

// The rate has no digits that a time in nanoseconds does not determine.
TEST_F(Info, StatesARoundRateAsThat) {
  for (const double rate_Hz : {24.0, 60.0, 120.0, 239.76, 1000.0}) {
    std::string rows = "time_s,position_mm\n";
    for (int k = 0; k < 50; ++k) rows += fmt::format("{:.9f},{}\n", 5000 + k / rate_Hz, k);
    const auto result = run_condyle({"info", folder_.write("rate.csv", rows), "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(nlohmann::json::parse(result.output)["rate_Hz"], rate_Hz);
  }
}

// Coarse times have other steps than the recording, and repeat at 200 Hz.
TEST_F(Info, StatesTheRateBehindRoundedTimes) {
  for (const auto& [rate_Hz, decimals] :
       {std::pair(240.0, 3), std::pair(60.0, 3), std::pair(59.94, 3), std::pair(120.0, 2),
        std::pair(200.0, 2)}) {
    std::string rows = "time_s,position_mm\n";
    for (int k = 0; k < 1500; ++k) {
      if (k % 100 >= 90) continue;  // gaps are no steps
      rows += fmt::format("{:.{}f},{}\n", k / rate_Hz, decimals, k % 90 * 0.1);
    }
    const auto result = run_condyle({"info", folder_.write("rounded.csv", rows), "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(nlohmann::json::parse(result.output)["rate_Hz"], rate_Hz) << decimals << " decimals";
  }
}

// A sample that is sent twice counts once.
TEST_F(Info, CountsNoRepeatedSampleAsAFrame) {
  std::string rows = "time_s,position_mm\n";
  for (int k = 0; k < 200; ++k) {
    for (int sent = 0; sent < (k % 3 == 0 ? 2 : 1); ++sent) {
      rows += fmt::format("{:.3f},{}\n", k * 0.02, k * 0.1);
    }
  }
  const auto result = run_condyle({"info", folder_.write("twice.csv", rows), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(nlohmann::json::parse(result.output)["rate_Hz"], 50);
}

TEST_F(Info, ShowsAnXdfFileThatWasExported) {
  const std::string xdf = (folder_.path() / "jaw.xdf").string();
  const auto exported = run_condyle({"export", path_, "--out", xdf});
  ASSERT_EQ(exported.exit_code, 0) << exported.errors;
  const auto result = run_condyle({"info", xdf, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["format"], "XDF");
  EXPECT_EQ(json["frames"], 200);
  EXPECT_EQ(json["rate_Hz"], 100);
  EXPECT_EQ(json["unit"], "mm");
  EXPECT_EQ(json["markers"], nlohmann::json({"chin", "left cheek"}));
  EXPECT_EQ(json["points"][0]["missing"], 10);
  EXPECT_EQ(json["time_gaps"], 0);
}

TEST_F(Info, AdvisesTheMarkerThatReplayNeeds) {
  const auto without = run_condyle({"replay", path_});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.errors, AllOf(HasSubstr("chin, left cheek"), HasSubstr("--marker NAME")));
  const auto wrong = run_condyle({"replay", path_, "--marker", "chinn"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.errors, HasSubstr("did you mean chin?"));
  const auto one = run_condyle({"replay", path_, "--marker", "left cheek"});
  EXPECT_EQ(one.exit_code, 0) << one.errors;
  EXPECT_THAT(one.output, HasSubstr("left cheek"));
}

TEST_F(Info, TakesAnAnalogueChannelAsDrive) {
  const auto driven =
      run_condyle({"replay", path_, "--marker", "left cheek", "--drive", "analog:force"});
  EXPECT_EQ(driven.exit_code, 0) << driven.errors;
  EXPECT_THAT(driven.output, HasSubstr("analogue channel force at 200 Hz: 399 samples"));
  const auto volts =
      run_condyle({"replay", path_, "--marker", "left cheek", "--drive", "analog:masseter"});
  EXPECT_EQ(volts.exit_code, 2);
  EXPECT_THAT(volts.errors, HasSubstr("not a unit of force"));
}

}  // namespace
}  // namespace condyle
