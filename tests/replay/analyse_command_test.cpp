// SPDX-License-Identifier: Apache-2.0
// `condyle analyse` as its users meet it: a simulated session, its figures, wrong input.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include "replay/analysed_readings.h"
#include "support/command.h"
#include "support/paths.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::Readings;
using testing_support::run_condyle;
using testing_support::source_path;
using testing_support::TemporaryFolder;

// The lines in the colour of openings, in a figure's units.
struct Lines {
  double longest = 0;  // straight piece
  double total = 0;
};
Lines lines_of(const std::string& svg) {
  static const std::regex kPath("<path stroke='rgb\\( 31,  95, 168\\)'\\s+d='([^']*)'");
  static const std::regex kPoint("([ML])([0-9.]+),([0-9.]+)");
  constexpr std::ptrdiff_t kLeastPoints = 3;  // two: the line of the key
  Lines lines;
  for (std::sregex_iterator path(svg.begin(), svg.end(), kPath), none; path != none; ++path) {
    const std::string points = (*path)[1];
    std::sregex_iterator point(points.begin(), points.end(), kPoint);
    if (std::distance(point, none) < kLeastPoints) continue;
    double x = 0, y = 0;
    for (; point != none; ++point) {
      const double to_x = std::stod((*point)[2]), to_y = std::stod((*point)[3]);
      const double length = (*point)[1] == "L" ? std::hypot(to_x - x, to_y - y) : 0;
      lines.longest = std::max(lines.longest, length);
      lines.total += length;
      x = to_x;
      y = to_y;
    }
  }
  return lines;
}

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
  // Writes the session with the rows that `change` changes: `up_mm` is added to their heights;
  // without a value, they are left out.
  using Change = std::function<std::optional<double>(double time_s)>;
  static std::string edited(const char* name, const Change& up_mm) {
    std::ifstream file(*folder_ / "jaw.csv");
    std::string line, text;
    std::getline(file, line);
    text = line + "\n";
    while (std::getline(file, line)) {
      std::stringstream fields(line);
      std::vector<double> row;
      for (std::string field; std::getline(fields, field, ',');) row.push_back(std::stod(field));
      const auto up = up_mm(row[0]);
      if (!up) continue;
      for (std::size_t z = 3; z < row.size(); z += 3) row[z] += *up;
      text += fmt::format("{:.9g}\n", fmt::join(row, ","));
    }
    return folder_->write(name, text);
  }
  static bool is_between(double time_s, double begin_s, double end_s) {
    return time_s > begin_s && time_s < end_s;
  }
  // The lines of the openings in the figure `name` of a recording.
  static Lines drawn(const std::string& recording, const char* name) {
    const std::string out = *folder_ / "drawn";
    const auto result = analyse({recording, "--landmarks", *folder_ / "jaw.landmarks.toml",
                                 "--task", "opening", "4.6", "15.6", "--out", out});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return lines_of(read_file(out + "/" + name));
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
  // In its own range, not that of the condyles.
  EXPECT_THAT(read_file(out + "/average_cycle.svg"), HasSubstr(">-20<"));
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

TEST_F(Analyse, DrawsNoLineOverSamplesThatAreMissing) {
  const auto whole = drawn(*folder_ / "jaw.csv", "incisor.svg");
  const auto with_gap =
      drawn(edited("gap.csv",
                   [](double time_s) {
                     return is_between(time_s, 6.0, 6.2) ? std::nullopt : std::optional(0.0);
                   }),
            "incisor.svg");
  ASSERT_GT(whole.longest, 0);
  EXPECT_LE(with_gap.longest, 1.2 * whole.longest);
  EXPECT_LT(with_gap.total, whole.total);
  EXPECT_GT(with_gap.total, 0.8 * whole.total);
}

// Of a part at a lower rate, and of samples that are lost one by one, all is drawn.
TEST_F(Analyse, DrawsThePathOfSparseSamples) {
  const auto whole = drawn(*folder_ / "jaw.csv", "incisor.svg");
  const auto third = [](double time_s) {
    return is_between(time_s, 4, 20) && std::lround(time_s * 60) % 3 != 0 ? std::nullopt
                                                                          : std::optional(0.0);
  };
  EXPECT_GT(drawn(edited("third.csv", third), "incisor.svg").total, 0.9 * whole.total);
  // A sample with a gap on both sides is a dot.
  const auto alone = [](double time_s) {
    const bool is_alone = is_between(time_s, 6.19, 6.207);
    return is_between(time_s, 6.0, 6.4) && !is_alone ? std::nullopt : std::optional(0.0);
  };
  drawn(edited("alone.csv", alone), "incisor.svg");
  EXPECT_THAT(read_file(*folder_ / "drawn/incisor.svg"), HasSubstr("#gpPt6"));
}

TEST_F(Analyse, DrawsBothCondylesInOneScale) {
  drawn(*folder_ / "jaw.csv", "condyles.svg");
  const std::string svg = read_file(*folder_ / "drawn/condyles.svg");
  // The frames: closed paths of five points in black.
  static const std::regex kFrame(
      "<path stroke='black'\\s+d='M([0-9.]+),([0-9.]+) L([0-9.]+),([0-9.]+) "
      "L([0-9.]+),([0-9.]+) L([0-9.]+),([0-9.]+) L([0-9.]+),([0-9.]+) Z");
  std::set<std::string> sizes;
  int frames = 0;
  for (std::sregex_iterator frame(svg.begin(), svg.end(), kFrame), none; frame != none; ++frame) {
    const auto number = [&](std::size_t i) { return std::stod((*frame)[i]); };
    sizes.insert(fmt::format("{:.0f} x {:.0f}", std::abs(number(5) - number(1)),
                             std::abs(number(6) - number(2))));
    ++frames;
  }
  EXPECT_GE(frames, 2);
  EXPECT_EQ(sizes.size(), 1U) << fmt::format("{}", fmt::join(sizes, ", "));
  // Anterior: to the right in the right condyle's panel, which comes first, to the left in the
  // other. The numbers below a panel are centred.
  static const std::regex kNumber(
      "translate\\(([0-9.]+),[0-9.]+\\)\"[^>]*text-anchor=\"middle\">\\s*<text><tspan[^>]*>\\s*"
      "(-?[0-9]+)</tspan>");
  constexpr double kMiddle = 600;
  double last_mm = NAN, last_at = NAN;
  int right = 0, left = 0;
  for (std::sregex_iterator number(svg.begin(), svg.end(), kNumber), none; number != none;
       ++number) {
    const double at = std::stod((*number)[1]), mm = std::stod((*number)[2]);
    if (mm > last_mm) {
      ++(at > last_at ? right : left);
      EXPECT_EQ(at > last_at, at < kMiddle) << "at " << at;
    }
    last_mm = mm;
    last_at = at;
  }
  EXPECT_GE(right, 2);
  EXPECT_EQ(left, right);
}

// A task of one sample has no extent; of a jaw at rest, a line would not be seen.
TEST_F(Analyse, DrawsWhatHardlyMovesAsADot) {
  for (const char* end_s : {"2.01", "2.1"}) {
    const auto result =
        analyse(session({"--task", "rest", "2.0", end_s, "--out", *folder_ / "moment"}));
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.errors, "");
    EXPECT_THAT(read_file(*folder_ / "moment/incisor.svg"), HasSubstr("#gpPt6"));
    std::filesystem::remove_all(*folder_ / "moment");
  }
  const auto moving =
      analyse(session({"--task", "opening", "6", "14", "--out", *folder_ / "moving"}));
  EXPECT_EQ(moving.exit_code, 0) << moving.errors;
  EXPECT_THAT(read_file(*folder_ / "moving/incisor.svg"), Not(HasSubstr("#gpPt6")));
}

// Samples that jump away are not used; the jaw may have jumped.
TEST_F(Analyse, SaysWhatItAssumesOfEachCycle) {
  const std::string out = *folder_ / "jump";
  const auto jump = [](double time_s) {
    return std::optional(is_between(time_s, 50.12, 50.17) ? 4.0 : 0.0);
  };
  ASSERT_EQ(analyse({edited("jump.csv", jump), "--landmarks", *folder_ / "jaw.landmarks.toml",
                     "--tasks", *folder_ / "jaw.tasks.csv", "--out", out, "--no-figures"})
                .exit_code,
            0);
  const auto cycles = testing_support::read_table(out + "/cycles.csv");
  int jumps = 0;
  std::string side;
  for (std::size_t i = 0; i < cycles.rows; ++i) {
    const bool has_jump = std::stod(cycles.columns.at("begin_s")[i]) < 50.12 &&
                          std::stod(cycles.columns.at("end_s")[i]) > 50.17;
    jumps += has_jump;
    if (has_jump) side = cycles.columns.at("side")[i];
    EXPECT_EQ(cycles.columns.at("assumed")[i].find("faults of the instrument") != std::string::npos,
              has_jump)
        << i;
  }
  EXPECT_EQ(jumps, 1);
  const auto average = testing_support::read_table(out + "/average_cycle.csv");
  int known = 0;
  for (std::size_t i = 0; i < average.rows; ++i) {
    if (average.columns.at("x_mm")[i].empty()) continue;
    const bool is_of_side = average.columns.at("side")[i] == side;
    known += is_of_side;
    EXPECT_EQ(average.columns.at("reason")[i].find("faults of the instrument") != std::string::npos,
              is_of_side);
  }
  EXPECT_GT(known, 0);
  const auto json = nlohmann::json::parse(read_file(out + "/readings.json"));
  for (const auto& one : json.at("recordings").at(0).at("average_cycles")) {
    if (!one.at("known") || one.at("side") != side) continue;
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

}  // namespace
}  // namespace condyle
