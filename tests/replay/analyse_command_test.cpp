// SPDX-License-Identifier: Apache-2.0
// `condyle analyse` as its users meet it: a simulated session, real recordings, wrong input.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "support/command.h"
#include "support/paths.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::reference_data;
using testing_support::run_condyle;
using testing_support::source_path;
using testing_support::TemporaryFolder;

// Readings printed as JSON, of the first recording.
class Readings {
 public:
  explicit Readings(const std::string& json)
      : recording_(nlohmann::json::parse(json).at("recordings").at(0)) {}

  // A mean over strokes; null if it is withheld.
  nlohmann::json value(const std::string& task, const std::string& reading,
                       const std::string& side = "") const {
    for (const auto& one : recording_.at("readings")) {
      if (one.at("task") == task && one.at("reading") == reading && one.at("side") == side &&
          one.at("stroke").is_null()) {
        return one;
      }
    }
    return nullptr;
  }
  bool all_are_withheld() const {
    for (const auto& one : recording_.at("readings")) {
      if (one.at("provenance") != "withheld" || one.at("reason") == "") return false;
    }
    return !recording_.at("readings").empty();
  }
  const nlohmann::json& recording() const { return recording_; }

 private:
  nlohmann::json recording_;
};

class Analyse : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const auto result =
        run_condyle({"simulate", source_path("/host_sim/scenarios/clinical_session.toml"), "--out",
                     *folder_ / "jaw.csv", "--truth", *folder_ / "truth.csv"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static CommandResult analyse(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "analyse");
    return run_condyle(arguments);
  }
  static std::vector<std::string> session(std::vector<std::string> more) {
    std::vector<std::string> arguments = {*folder_ / "jaw.csv", "--landmarks",
                                          *folder_ / "jaw.landmarks.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  static std::string landmarks_with(const std::string& key, const std::string& value) {
    std::ifstream file(*folder_ / "jaw.landmarks.toml");
    std::string text;
    for (std::string line; std::getline(file, line);) {
      text += line.starts_with(key + " ") ? key + " = " + value + "\n" : line + "\n";
    }
    return folder_->write("changed.toml", text);
  }
  // The session, of which rows that are not kept are moved up (mm), or left out if by 0.
  static std::string edited(const char* name, const std::function<bool(double time_s)>& is_kept,
                            double up_mm) {
    std::ifstream file(*folder_ / "jaw.csv");
    std::string line, text;
    std::getline(file, line);
    text = line + "\n";
    while (std::getline(file, line)) {
      std::stringstream fields(line);
      std::string row;
      int column = 0;
      double time_s = 0;
      for (std::string field; std::getline(fields, field, ','); ++column) {
        if (column == 0) time_s = std::stod(field);
        const bool is_up = column > 0 && column % 3 == 0 && !is_kept(time_s);
        row += (column > 0 ? "," : "") +
               (is_up ? fmt::format("{:.6f}", std::stod(field) + up_mm) : field);
      }
      if (up_mm != 0 || is_kept(time_s)) text += row + "\n";
    }
    return folder_->write(name, text);
  }
  static std::string problem(const std::vector<std::string>& arguments) {
    const auto result = analyse(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    return result.errors;
  }

  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(Analyse, WritesReadingsThatContainTheTruth) {
  const std::string out = *folder_ / "readings";
  const auto result = analyse(session({"--tasks", *folder_ / "jaw.tasks.csv", "--out", out}));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("usable      yes"), HasSubstr("mean of 3 strokes")));
  for (const char* name : {"/readings.csv", "/readings.json", "/cycles.csv", "/poses.csv",
                           "/summary.txt", "/incisor.png", "/condyles.svg"}) {
    EXPECT_TRUE(std::filesystem::exists(out + name)) << name;
  }
  std::ifstream json(out + "/readings.json");
  std::stringstream text;
  text << json.rdbuf();
  const Readings readings(text.str());
  const auto truth = testing_support::read_table(*folder_ / "jaw.readings.csv");
  int compared = 0, covered = 0;
  for (std::size_t i = 0; i < truth.rows; ++i) {
    const auto field = [&](const char* name) { return truth.columns.at(name)[i]; };
    if (field("stroke") != "0" && !field("stroke").empty()) continue;
    const std::string reading = field("reading");
    if (reading == "rotation_deg" || reading == "displacement_mm") continue;  // of the whole task
    const auto found = readings.value(field("task"), reading, field("side"));
    if (found.is_null() || found.at("value").is_null()) continue;
    const double value = std::stod(field("value"));
    ++compared;
    covered += found.at("low") <= value && value <= found.at("high");
  }
  EXPECT_GT(compared, 40);
  // One draw of the landmarks moves many readings together.
  EXPECT_GE(covered, compared * 4 / 5);
}

// The length of the longest straight piece of the openings in a figure, in its units.
double longest_piece(const std::string& svg) {
  static const std::regex kPath("<path stroke='rgb\\( 31,  95, 168\\)'\\s+d='([^']*)'");
  static const std::regex kPoint("([ML])([0-9.]+),([0-9.]+)");
  constexpr std::ptrdiff_t kLeastPoints = 10;  // fewer: the line of the key
  double longest = 0;
  for (std::sregex_iterator path(svg.begin(), svg.end(), kPath), none; path != none; ++path) {
    const std::string points = (*path)[1];
    std::sregex_iterator point(points.begin(), points.end(), kPoint);
    if (std::distance(point, none) < kLeastPoints) continue;
    double x = 0, y = 0;
    for (; point != none; ++point) {
      const double to_x = std::stod((*point)[2]), to_y = std::stod((*point)[3]);
      if ((*point)[1] == "L") longest = std::max(longest, std::hypot(to_x - x, to_y - y));
      x = to_x;
      y = to_y;
    }
  }
  return longest;
}

TEST_F(Analyse, DrawsNoLineOverSamplesThatAreMissing) {
  const std::string whole = *folder_ / "whole", with_gap = *folder_ / "with_gap";
  const std::vector<std::string> more = {
      "--landmarks", *folder_ / "jaw.landmarks.toml", "--task", "opening", "4.6", "15.6", "--out"};
  const auto draw = [&](const std::string& recording, const std::string& out) {
    std::vector<std::string> arguments = {recording};
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.push_back(out);
    EXPECT_EQ(analyse(arguments).exit_code, 0);
    return longest_piece(read_file(out + "/incisor.svg"));
  };
  const double usual = draw(*folder_ / "jaw.csv", whole);
  ASSERT_GT(usual, 0);
  const auto is_kept = [](double time_s) { return time_s < 6.0 || time_s > 6.2; };
  EXPECT_LE(draw(edited("gap.csv", is_kept, 0), with_gap), 1.2 * usual);
}

// Samples that jump away are not used; the jaw may have jumped.
TEST_F(Analyse, SaysWhatItAssumesOfEachCycle) {
  const auto is_kept = [](double time_s) { return time_s < 50.12 || time_s > 50.17; };
  const std::string jump = edited("jump.csv", is_kept, 4), out = *folder_ / "jump";
  ASSERT_EQ(analyse({jump, "--landmarks", *folder_ / "jaw.landmarks.toml", "--tasks",
                     *folder_ / "jaw.tasks.csv", "--out", out, "--no-figures"})
                .exit_code,
            0);
  const auto cycles = testing_support::read_table(out + "/cycles.csv");
  ASSERT_GT(cycles.rows, 0U);
  for (std::size_t i = 0; i < cycles.rows; ++i) {
    const bool has_jump = std::stod(cycles.columns.at("begin_s")[i]) < 50.12 &&
                          std::stod(cycles.columns.at("end_s")[i]) > 50.17;
    EXPECT_EQ(cycles.columns.at("assumed")[i].find("faults of the instrument") != std::string::npos,
              has_jump)
        << i;
  }
  const auto average = testing_support::read_table(out + "/average_cycle.csv");
  int known = 0;
  for (std::size_t i = 0; i < average.rows; ++i) {
    if (average.columns.at("x_mm")[i].empty()) continue;
    ++known;
    EXPECT_THAT(average.columns.at("reason")[i], HasSubstr("faults of the instrument"));
  }
  EXPECT_GT(known, 0);
  const auto json = nlohmann::json::parse(read_file(out + "/readings.json"));
  for (const auto& one : json.at("recordings").at(0).at("average_cycles")) {
    if (!one.at("known")) continue;
    EXPECT_THAT(one.at("reason"), HasSubstr("faults of the instrument"));
  }
}

TEST_F(Analyse, FindsTheTasksThatAreNotStated) {
  const auto result = analyse(session({"--json"}));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Readings readings(result.output);
  std::map<std::string, int> tasks;
  for (const auto& task : readings.recording().at("tasks")) {
    ++tasks[task.at("task")];
    EXPECT_TRUE(task.at("found"));
  }
  EXPECT_EQ(tasks["opening"], 3);
  EXPECT_EQ(tasks["protrusion"], 3);
  EXPECT_EQ(tasks["left"], 3);
  EXPECT_EQ(tasks["right"], 3);
  EXPECT_GE(tasks["chewing"], 1);
  EXPECT_THAT(readings.value("opening", "opening_mm").at("reason"), HasSubstr("found"));
}

TEST_F(Analyse, IsAlsoSpeltAnalyze) {
  const auto result = run_condyle({"analyze", *folder_ / "jaw.csv", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  // Without landmarks nothing is guessed.
  const Readings readings(result.output);
  EXPECT_FALSE(readings.value("", "rotation_deg").at("value").is_null());
}

TEST_F(Analyse, TakesTasksFromTheCommandLine) {
  const auto result = analyse(session({"--task", "opening", "4.6", "15.6", "--task", "rest", "0.6",
                                       "4.4", "--reference-s", "0.6", "4.4", "--json"}));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Readings readings(result.output);
  EXPECT_EQ(readings.value("opening", "opening_mm").at("provenance"), "measured");
  EXPECT_EQ(readings.recording().at("reference"), "stated");
}

TEST_F(Analyse, KeepsTheOthersIfOneFileIsBad) {
  const std::string out = *folder_ / "two";
  const std::string bad = folder_->write("bad.csv", "time_s,position_m\n0,1\n");
  const auto result = analyse({*folder_ / "jaw.csv", bad, "--out", out, "--no-figures"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("bad.csv"));
  EXPECT_GT(testing_support::read_table(out + "/readings.csv").rows, 0U);
}

TEST_F(Analyse, SaysWhatIsWrongAndTheRemedy) {
  const std::string jaw = *folder_ / "jaw.csv";
  const auto with = [&](const std::string& landmarks) {
    return problem({jaw, "--landmarks", landmarks});
  };
  EXPECT_THAT(with(landmarks_with("condyle_left", "[300, 900, 0]")), HasSubstr("mm"));
  EXPECT_THAT(with(landmarks_with("incisor_lower", "[2, 0, 0]")),
              AllOf(HasSubstr("changed.toml"), HasSubstr("incisor")));
  EXPECT_THAT(with(landmarks_with("plane_front", "[-9.4, 54.5, 1.9]")), HasSubstr("line"));
  EXPECT_THAT(with(landmarks_with("plane_front", "\"x\"")), HasSubstr("changed.toml"));
  EXPECT_THAT(with(*folder_ / "none.toml"), HasSubstr("none.toml"));
  EXPECT_THAT(problem(session({"--task", "opening", "900", "910"})),
              AllOf(HasSubstr("outside"), HasSubstr("lasts from")));
  EXPECT_THAT(problem(session({"--task", "yawning", "1", "2"})), HasSubstr("opening, protrusion"));
  EXPECT_THAT(problem(session({"--task", "opening", "3", "2"})), HasSubstr("begin"));
  EXPECT_THAT(problem(session({"--reference-s", "500", "501"})), HasSubstr("between"));
  EXPECT_THAT(problem(session({"--tasks", folder_->write("t.csv", "task,begin_s\nopening,1\n")})),
              AllOf(HasSubstr("t.csv"), HasSubstr("end_s")));
  EXPECT_THAT(problem({folder_->write("axis.csv", "time_s,position_m\n0,0\n1,1\n")}),
              HasSubstr("replay"));
  EXPECT_THAT(problem({jaw, jaw}), HasSubstr("twice"));
}

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
