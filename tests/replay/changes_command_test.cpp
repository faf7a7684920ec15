// SPDX-License-Identifier: Apache-2.0
// changes: what it says of a simulated friction that steps, and of one that does not, and what it
// withholds.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "support/command.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

// A point mass that chews for 220 s at 60 Hz; its friction of 0.022 Ns/m becomes four times that at
// 170 s, or stays.
class Changes : public testing::Test {
 protected:
  std::string record(const std::string& name, double factor, double duration_s = 220) {
    const std::string scenario = folder_.write(
        name + ".toml",
        fmt::format("duration_s = {}\n[subject]\nmotion = \"point_mass\"\ndrive = \"force\"\n"
                    "mass_kg = 0.25\nsupport_stiffness_N_m = 20\nsupport_rest_m = -0.010\n"
                    "[task]\nrest_position_m = 0.0\namplitude_m = 0.015\namplitude_spread = 0.12\n"
                    "cycle_rate_Hz = 1.3\nrate_spread = 0.08\npause_probability = 0.02\n"
                    "[friction]\nviscous_Ns_m = 0.022\n{}"
                    "[drive]\nrate_Hz = 60\nnoise_N = 0.01\n",
                    duration_s,
                    factor != 1 ? fmt::format("change = \"step\"\nchange_start_s = 170\n"
                                              "change_factor = {}\n",
                                              factor)
                                : ""));
    const auto result = run_condyle({"simulate", scenario, "--out", folder_ / (name + ".csv")});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return folder_ / name;
  }
  static CommandResult changes(const std::string& name, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"changes",
                                          name + ".csv",
                                          "--drive",
                                          name + ".drive.csv",
                                          "--false-alarm-interval-h",
                                          "8",
                                          "--drive-delay-sd-ms",
                                          "0.5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_condyle(arguments);
  }

  TemporaryFolder folder_;
};

TEST_F(Changes, RaisesOneAlarmAfterTheStep) {
  const std::string name = record("step", 4);
  const auto result = changes(name, {"--drive-missing", "0", "--out", folder_ / "cycles.csv",
                                     "--figures", folder_ / "figures"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("effective damping INCREASED from"),
                                   HasSubstr("it is not a diagnosis"),
                                   HasSubstr("research use only"), HasSubstr("can detect"),
                                   Not(HasSubstr("DECREASED")), Not(HasSubstr("WITHHELD"))));
  const auto table = testing_support::read_table(folder_ / "cycles.csv");
  const auto ends_s = table.numbers("end_s"), begins_s = table.numbers("begin_s");
  const auto damping = table.numbers("damping_Ns_m"), up = table.numbers("statistic_up");
  const auto threshold = table.numbers("threshold"), sd = table.numbers("damping_sd_Ns_m");
  int alarms = 0, counted = 0;
  double error = 0;
  for (std::size_t i = 0; i < table.rows; ++i) {
    const std::string& state = table.columns.at("state")[i];
    if (state == "increased") {
      ++alarms;
      EXPECT_GT(ends_s[i], 170);
      EXPECT_GT(up[i], threshold[i]);
    }
    if (table.columns.at("outcome")[i] != "counted") continue;
    EXPECT_LT(begins_s[i], ends_s[i]);
    if (ends_s[i] < 170) {
      ++counted;
      error += std::pow((damping[i] - 0.022) / sd[i], 2);
    }
  }
  EXPECT_EQ(alarms, 1);
  EXPECT_GT(counted, 100);
  EXPECT_NEAR(error / counted, 1, 0.4);
  EXPECT_THAT(read_file(folder_ / "figures/changes.svg"),
              AllOf(HasSubstr("research use only"), HasSubstr("threshold")));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "figures/changes.png"));
}

TEST_F(Changes, RaisesNoneWithoutAStep) {
  const auto result = changes(record("steady", 1), {"--drive-missing", "0"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("none was found"), HasSubstr("one in 8 h of chewing"),
                                   HasSubstr("in half of the cases"), Not(HasSubstr("CREASED"))));
}

// What the drive may miss is as good an explanation of the alarm.
TEST_F(Changes, WithholdsWhatTheDriveMayHaveMade) {
  const auto result = changes(record("step", 4), {"--drive-missing", "0.04"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("WITHHELD"), HasSubstr("the drive alone may have caused"),
                    Not(HasSubstr("CREASED"))));
}

// Damping a hundred times as large is another point, which is no longer followed.
TEST_F(Changes, WithholdsAllOnceThePointIsLost) {
  const auto result = changes(record("jump", 100), {"--drive-missing", "0"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("no longer fits the identified model"),
                                   HasSubstr("none was found before")));
}

TEST_F(Changes, SaysWhatItCannotUse) {
  const std::string name = record("short", 1, 90);
  const auto refuse = [](const CommandResult& result, const char* words) {
    EXPECT_EQ(result.exit_code, 2) << words;
    EXPECT_THAT(result.errors, HasSubstr(words));
    EXPECT_EQ(result.output, "");
  };
  refuse(
      changes(name),
      "a change of damping is known only if the share of the force that the drive misses is known");
  refuse(changes(name, {"--drive-missing", "1"}), "only if the share of the force");
  refuse(changes(name, {"--drive-missing", "0", "--out", name + ".csv"}), "is also an input");
  const std::string interval = "--false-alarm-interval-h";
  refuse(run_condyle({"changes", name + ".csv", interval, "8", "--drive-missing", "0"}),
         "has no drive");
  refuse(run_condyle({"changes", name + ".csv", "--drive", name + ".drive.csv", interval, "0.001",
                      "--drive-missing", "0"}),
         "cycles of this recording");
  EXPECT_EQ(run_condyle({"changes", name + ".csv", "--drive", name + ".drive.csv"}).exit_code, 2);
  EXPECT_EQ(changes(name, {"--smallest-change-Ns-m", "nan"}).exit_code, 2);
  refuse(changes(name, {"--drive-missing", "0", "--coulomb-sd-N", "0.1"}),
         "counts all friction as effective damping");
  const std::string longer = folder_.write("long.toml", "[changes]\nidentification_s = 200\n");
  refuse(changes(name, {"--drive-missing", "0", "--parameters", longer}),
         "is too short to identify the point");
  const std::string wrong = folder_.write("wrong.toml", "[changes]\nbaseline_cycles = 2\n");
  refuse(changes(name, {"--drive-missing", "0", "--parameters", wrong}), "out of range");

  // Long enough to identify, too short to judge a cycle.
  const auto result = changes(name, {"--drive-missing", "0"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("NOT WATCHED"), HasSubstr("record longer"),
                                   Not(HasSubstr("none was found"))));
}

// A drive that is not the one that moves the point.
TEST_F(Changes, RefusesADriveThatDoesNotExplainTheMotion) {
  const std::string name = record("other", 1, 90);
  std::istringstream rows(read_file(name + ".drive.csv"));
  std::string other, row;
  std::getline(rows, row);
  other = row + "\n";
  while (std::getline(rows, row)) {
    const std::size_t comma = row.find(',');
    const double time_s = std::stod(row), drive_N = std::stod(row.substr(comma + 1));
    other += fmt::format("{},{}\n", row.substr(0, comma), drive_N + 0.05 * std::sin(20 * time_s));
  }
  folder_.write("other.drive.csv", other);
  const auto result = changes(name, {"--drive-missing", "0"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("do not explain the motion"));
}

}  // namespace
}  // namespace condyle
