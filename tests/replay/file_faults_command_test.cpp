// SPDX-License-Identifier: Apache-2.0
// What real files hold beside a motion, and what a replay says of it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "support/command.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::read_table;
using testing_support::run_condyle;
using testing_support::Table;
using testing_support::TemporaryFolder;

struct PointMotion {
  int rows = 900;
  double rate_Hz = 60;
  double x_mm = 2, y_mm = 1, z_mm = 10;  // half of the ranges
  double noise_mm = 0.03, step_mm = 0;
  int drops_every = 0;  // frames, under even times
};

std::vector<std::string> cells(const PointMotion& motion) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0, motion.noise_mm);
  std::vector<std::string> rows;
  for (int i = 0; static_cast<int>(rows.size()) < motion.rows; ++i) {
    const double phase = 2 * M_PI * 0.9 * i / motion.rate_Hz;
    double xyz_mm[] = {motion.x_mm * std::sin(phase), 40 + motion.y_mm * std::cos(phase),
                       -motion.z_mm * std::cos(phase + 0.4)};
    for (double& value : xyz_mm) {
      value += noise(random);
      if (motion.step_mm > 0) value = std::round(value / motion.step_mm) * motion.step_mm;
    }
    if (motion.drops_every > 0 && i % motion.drops_every == 2) continue;
    rows.push_back(fmt::format("{:.6f},{:.6f},{:.6f}", xyz_mm[0], xyz_mm[1], xyz_mm[2]));
  }
  return rows;
}

std::string csv(const std::vector<std::string>& rows, double rate_Hz) {
  std::string text = "time_s,p1_x_mm,p1_y_mm,p1_z_mm\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += fmt::format("{:.9f},{}\n", static_cast<double>(i) / rate_Hz, rows[i]);
  }
  return text;
}

std::string csv(const PointMotion& motion) {
  return csv(cells(motion), motion.rate_Hz);
}

class FileFaults : public testing::TestWithParam<const char*> {
 protected:
  CommandResult replay(const std::string& content, std::vector<std::string> more = {}) {
    more.insert(more.begin(),
                {"replay", folder_.write("r.csv", content), "--estimator", GetParam()});
    const CommandResult result = run_condyle(more);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return result;
  }
  const TemporaryFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(Estimators, FileFaults, testing::Values("recommended", "published"),
                         [](const auto& named) { return std::string(named.param); });

// Numbers beyond 10 m give the estimates and the figures of missing values.
TEST_P(FileFaults, SentinelsAreMissingValues) {
  const PointMotion motion;
  std::vector<std::string> far = cells(motion), missing = far;
  // The first is a value that makers write for a missing one: it is missing, not out of range.
  const char* const sentinels[] = {"-3.7e31,0.1,2", "1,1e8,3", "120000,-120000,120000"};
  for (std::size_t i = 50; i < far.size(); i += 50) {
    far[i] = sentinels[i / 50 % 3];
    missing[i] = ",,";
  }
  const auto write = [&](const char* name, const std::vector<std::string>& rows) {
    return replay(csv(rows, motion.rate_Hz), {"--faults", "event", "--out", folder_ / name + ".csv",
                                              "--figures", folder_ / name});
  };
  EXPECT_THAT(write("far", far).output, testing::AllOf(HasSubstr("17 position_missing"),
                                                       HasSubstr("12 position_out_of_range")));
  EXPECT_THAT(write("missing", missing).output, Not(HasSubstr("position_out_of_range")));
  Table with_far = read_table(folder_ / "far.csv"), with_none = read_table(folder_ / "missing.csv");
  EXPECT_EQ(with_far.columns.at("events")[50],
            with_none.columns.at("events")[50] + "|position_out_of_range");
  with_far.columns.erase("events");
  with_none.columns.erase("events");
  EXPECT_EQ(with_far.columns, with_none.columns);
  int figures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "far")) {
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(read_file(entry.path().string()), read_file(folder_ / "missing/" + name)) << name;
    ++figures;
  }
  EXPECT_GE(figures, 6);
  EXPECT_THAT(replay(csv(far, motion.rate_Hz)).output, HasSubstr("12 position_out_of_range"))
      << "they end no replay";
}

TEST_P(FileFaults, AWrongUnitIsNamed) {
  const CommandResult result = replay("time_s,position_m\n0,40\n0.02,41\n0.04,40\n");
  EXPECT_THAT(result.output, HasSubstr("none: no sample had a position; 3 were beyond 10 m: check "
                                       "their unit\n"));
}

// The advice is followed: then there is nothing to warn of.
TEST_P(FileFaults, AMotionAlongAnotherAxisIsSaid) {
  EXPECT_THAT(replay(csv(PointMotion{})).errors, Not(HasSubstr("--axis")));
  const struct {
    double x_mm, y_mm, z_mm;
    const char* axis;
  } cases[] = {{15, 2, 0.2, "x"}, {1, 8, 3, "y"}};
  for (const auto& [x_mm, y_mm, z_mm, axis] : cases) {
    PointMotion motion{.x_mm = x_mm, .y_mm = y_mm, .z_mm = z_mm};
    std::vector<std::string> rows = cells(motion);
    rows[100] = "3,4,900";  // one glitch decides nothing
    const std::string recording = csv(rows, motion.rate_Hz), advice = std::string("--axis ") + axis;
    const CommandResult warned = replay(recording);
    EXPECT_THAT(warned.errors, HasSubstr(fmt::format("warning: the motion is along {} (", axis)));
    EXPECT_THAT(warned.errors, HasSubstr(advice + " follows it"));
    const CommandResult followed = replay(recording, {"--axis", axis});
    EXPECT_THAT(followed.errors, Not(HasSubstr("--axis")));
    EXPECT_THAT(followed.output, HasSubstr(fmt::format("axis {}\n", axis)));
    EXPECT_THAT(followed.output, HasSubstr("ranges      x "));
  }
}

TEST_P(FileFaults, DroppedFramesAreSaid) {
  EXPECT_THAT(replay(csv(PointMotion{.rate_Hz = 100})).output, Not(HasSubstr("frames ")));
  const PointMotion dropping{.rate_Hz = 100, .drops_every = 5};
  EXPECT_THAT(replay(csv(dropping)).output,
              HasSubstr("are two frames long: frames were dropped under even time stamps\n"));
}

TEST(Recommended, SaysThatRoundingHidesSmoothing) {
  const TemporaryFolder folder;
  const auto replay = [&](double step_mm) {
    return run_condyle(
        {"replay", folder.write("r.csv", csv(PointMotion{.rows = 3000, .step_mm = step_mm}))});
  };
  const CommandResult fine = replay(0.001), coarse = replay(0.1);
  EXPECT_THAT(fine.output, Not(HasSubstr("rounding")));
  EXPECT_EQ(fine.errors, "");
  EXPECT_THAT(fine.output, HasSubstr("(95 %), measured"));
  EXPECT_THAT(fine.output, HasSubstr("noise model white; slow noise"));
  EXPECT_THAT(coarse.output, HasSubstr("rounding    x 0.1, y 0.1, z 0.1 mm, most of the noise"));
  EXPECT_THAT(coarse.errors, HasSubstr("if they were also smoothed, a 95 % interval"));
  EXPECT_THAT(coarse.output, Not(HasSubstr("(95 %)")));
  EXPECT_THAT(coarse.output, HasSubstr("(95 % unless smoothed before), measured"));
}

}  // namespace
}  // namespace condyle
