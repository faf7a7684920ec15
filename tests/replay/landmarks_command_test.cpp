// SPDX-License-Identifier: Apache-2.0
// `condyle landmarks` and the bodies of `condyle analyse` and `condyle report` as users meet them.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "replay/pointer_session.h"
#include "support/command.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::condyle_has;
using testing_support::kLandmarks;
using testing_support::kNames;
using testing_support::kOpening_rad;
using testing_support::pointer_session;
using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

class LandmarksCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    recording_ = folder_->write("session.csv", pointer_session());
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static std::vector<std::string> arguments(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"landmarks", recording_, "--out", *folder_ / "l.toml"};
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      const double begin_s = 9.2 + 1.5 * static_cast<double>(i);
      words.insert(words.end(), {"--at", kNames[i], fmt::format("{:g}", begin_s),
                                 fmt::format("{:g}", begin_s + 1)});
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static std::vector<std::string> tracked() {
    return {"--pointer", "S1,S2,S3", "--tip-calibration", "0", "8.5", "--jaw", "J1,J2,J3,J4",
            "--head",    "H1,H2,H3", "--reference-s",     "1", "2"};
  }
  static std::string problem(const std::vector<std::string>& words) {
    const auto result = run_condyle(words);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    return result.errors;
  }

  static inline TemporaryFolder* folder_ = nullptr;
  static inline std::string recording_;
};

TEST_F(LandmarksCommand, AndAnalyseReadTheTruthWhileTheHeadMoves) {
  const auto taken = run_condyle(arguments(tracked()));
  ASSERT_EQ(taken.exit_code, 0) << taken.errors;
  EXPECT_THAT(taken.output, AllOf(HasSubstr("tip  "), HasSubstr("condyle_left"),
                                  HasSubstr("pointer: S1, S2, S3 misfit")));
  EXPECT_THAT(read_file(*folder_ / "l.toml"), HasSubstr("head_points = \"H1,H2,H3\""));
  const std::vector<std::string> of_bodies = {
      recording_, "--landmarks", *folder_ / "l.toml", "--jaw", "J1,J2,J3,J4", "--head",
      "H1,H2,H3", "--task",      "opening",           "20",    "29.9",        "--reference-s",
      "1",        "19"};
  std::vector<std::string> words = {"analyse", "--json"};
  words.insert(words.end(), of_bodies.begin(), of_bodies.end());
  const auto analysed = run_condyle(words);
  ASSERT_EQ(analysed.exit_code, 0) << analysed.errors;
  const auto json = nlohmann::json::parse(analysed.output).at("recordings").at(0);
  EXPECT_TRUE(json.at("usable"));
  int found = 0;
  for (const auto& one : json.at("readings")) {
    if (!one.at("stroke").is_null() || one.at("value").is_null()) continue;
    const double incisor_mm = 2 * std::sin(kOpening_rad / 2) * std::hypot(95, 40);
    const double truth = one.at("reading") == "opening_angle_deg" ? kOpening_rad * 180 / M_PI
                         : one.at("reading") == "opening_mm"      ? incisor_mm
                                                                  : std::nan("");
    if (std::isnan(truth)) continue;
    ++found;
    EXPECT_LE(one.at("low"), truth) << one;
    EXPECT_GE(one.at("high"), truth) << one;
    EXPECT_NEAR(one.at("value"), truth, 0.1);
  }
  EXPECT_EQ(found, 2);
  // Without the head, the jaw's points are not where they were.
  words = {"analyse",       recording_, "--landmarks", *folder_ / "l.toml", "--jaw", "J1,J2,J3,J4",
           "--reference-s", "4.2",      "4.6"};
  EXPECT_THAT(problem(words), AnyOf(HasSubstr("give --head"), HasSubstr("the jaw moves")));
  if (!condyle_has("report")) GTEST_SKIP() << "built without report";
  words = {"report", "--out", *folder_ / "report.html"};
  words.insert(words.end(), of_bodies.begin(), of_bodies.end());
  const auto report = run_condyle(words);
  ASSERT_EQ(report.exit_code, 0) << report.errors;
  EXPECT_THAT(read_file(*folder_ / "report.html"),
              AllOf(HasSubstr("opening_angle_deg"), HasSubstr("estimates over time are left out")));
}

TEST_F(LandmarksCommand, SaysWhatIsWrongAndTheRemedy) {
  auto words = arguments(tracked());
  words.insert(words.end(), {"--at", "condile_left", "1", "2"});
  EXPECT_THAT(problem(words), HasSubstr("did you mean condyle_left?"));
  EXPECT_THAT(problem(arguments()), AllOf(HasSubstr("--pointer"), HasSubstr("--point NAME")));
  EXPECT_THAT(problem(arguments({"--pointer", "S1,S2,S3"})), HasSubstr("--tip-calibration BEGIN"));
  EXPECT_THAT(problem(arguments({"--pointer", "S1,S2", "--tip", "0", "0", "1"})),
              HasSubstr("names 2 points"));
  EXPECT_THAT(problem(arguments({"--point", "S9"})),
              AllOf(HasSubstr("no point S9"), HasSubstr("J1, J2"), HasSubstr("S3")));
  EXPECT_THAT(problem(arguments({"--point", "S1"})), HasSubstr("moves by"));
  words = arguments(tracked());
  words.insert(words.end(), {"--at", "plane_left", "2", "1"});
  EXPECT_THAT(problem(words), HasSubstr("begin, then the end"));
  words = arguments(tracked());
  words.insert(words.end(), {"--at", "plane_left", "15.3", "16.1"});  // on the right one
  EXPECT_THAT(problem(words), HasSubstr("the points of the reference plane coincide"));
  words = arguments(tracked());
  words[3] = recording_;
  EXPECT_THAT(problem(words), HasSubstr("session.csv"));
  const std::string axis = folder_->write("axis.csv", "time_s,position_m\n0,0\n1,1\n");
  words = arguments(tracked());
  words[1] = axis;
  EXPECT_THAT(problem(words), HasSubstr("has no points"));
}

TEST_F(LandmarksCommand, BodiesOfAnalyseAreChecked) {
  const auto with = [](std::vector<std::string> more) {
    more.insert(more.begin(), {"analyse", recording_});
    return problem(more);
  };
  EXPECT_THAT(with({}), AllOf(HasSubstr("not one rigid body"), HasSubstr("--jaw A,B,C")));
  EXPECT_THAT(with({"--jaw", "J1,J2"}), HasSubstr("--jaw: names 2 points"));
  EXPECT_THAT(with({"--jaw", "J1,J2,J1"}), HasSubstr("twice"));
  EXPECT_THAT(with({"--jaw", "J1,,J2"}), HasSubstr("empty"));
  EXPECT_THAT(with({"--jaw", "J1,J2,Jx"}),
              AllOf(HasSubstr("no point Jx"), HasSubstr("its points are J1")));
  EXPECT_THAT(with({"--jaw", "J1,J2,J3", "--head", "J3,H1,H2"}), HasSubstr("also one of --jaw"));
  EXPECT_THAT(with({"--jaw", "J1,J2,J3", "--head", "H1,H2,H3", "--moving", "upper"}),
              HasSubstr("leave out --moving"));
  EXPECT_THAT(problem({"analyse", folder_->write("axis.csv", "time_s,position_m\n0,0\n1,1\n"),
                       "--jaw", "A,B,C"}),
              HasSubstr("leave out --jaw"));
  // replay follows one point, and says how to choose.
  EXPECT_THAT(problem({"replay", recording_}), HasSubstr("--ignore-column"));
}

TEST_F(LandmarksCommand, MistypedKeysAndWrongFramesAreNamed) {
  ASSERT_EQ(run_condyle(arguments(tracked())).exit_code, 0);
  const std::string good = read_file(*folder_ / "l.toml");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return problem({"analyse", recording_, "--jaw", "J1,J2,J3,J4", "--head", "H1,H2,H3",
                    "--landmarks", folder_->write("wrong.toml", text)});
  };
  EXPECT_THAT(with("condyle_left", "condyle_lefft"),
              AllOf(HasSubstr("wrong.toml:3"), HasSubstr("did you mean condyle_left?")));
  EXPECT_THAT(with("[landmarks]", "[landmark]"), HasSubstr("did you mean landmarks?"));
  EXPECT_THAT(with("head_points = \"H1,", "head_points = \"H1,H9,"), HasSubstr("4 points"));
  EXPECT_THAT(with("head_points = \"H1,H2,H3\"", "head_points = \"X,Y,Z\""),
              HasSubstr("has 0 of the points"));
  // In the frame of another instrument: all are 800 mm away.
  std::string far = "[landmarks]\n";
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    far += fmt::format("{} = [{}, {}, {}]\n", kNames[i], kLandmarks[i][0] + 800, kLandmarks[i][1],
                       kLandmarks[i][2]);
  }
  EXPECT_THAT(
      problem({"analyse", recording_, "--jaw", "J1,J2,J3,J4", "--head", "H1,H2,H3", "--reference-s",
               "2", "2.2", "--landmarks", folder_->write("far.toml", far)}),
      AllOf(HasSubstr("mm from the points that the recording tracks"),
            HasSubstr("this recording's instrument")));
}

}  // namespace
}  // namespace condyle
