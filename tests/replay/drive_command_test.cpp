// SPDX-License-Identifier: Apache-2.0
// replay with a measured drive: what it shows of friction and mass, and what it withholds.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

#include "replay/command.h"
#include "replay/table.h"
#include "support/paths.h"
#include "unit/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::run_condyle;

class Estimates {
 public:
  explicit Estimates(const std::string& path) : table_(testing_support::read_table(path)) {}
  std::size_t last() const { return table_.rows - 1; }
  std::string text(const char* column, std::size_t row) const {
    return table_.columns.at(column).at(row);
  }
  double number(const char* column, std::size_t row) const {
    return table_.numbers(column).at(row);
  }

 private:
  testing_support::Table table_;
};

class Drive : public testing::Test {
 protected:
  // A point mass of 0.25 kg and 0.022 Ns/m, its drive in a file of its own.
  void SetUp() override {
    const auto result = run_condyle(
        {"simulate", testing_support::source_path("/host_sim/scenarios/point_mass.toml"), "--out",
         recording_});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  CommandResult replay(const std::string& recording, std::vector<std::string> options) {
    std::vector<std::string> arguments = {"replay", recording, "--out", estimates_};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_condyle(arguments);
  }
  // The recording with its drive as a column, which both were measured at the same times.
  std::string with_column() {
    std::istringstream positions(read_file(recording_)), drive(read_file(drive_));
    std::string text, position, force;
    while (std::getline(positions, position) && std::getline(drive, force)) {
      text += position + force.substr(force.find(',')) + '\n';
    }
    return folder_.write("both.csv", text);
  }

  testing_support::TemporaryFolder folder_;
  std::string recording_ = folder_ / "bow.csv", drive_ = folder_ / "bow.drive.csv";
  std::string estimates_ = folder_ / "estimates.csv";
  const std::vector<std::string> complete_ = {
      "--drive",         drive_, "--drive-missing", "0", "--drive-delay-sd-ms", "0",
      "--drive-gain-sd", "0"};
};

TEST_F(Drive, MeasuresFrictionAndMassWhereItIsComplete) {
  const auto result = replay(recording_, complete_);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("friction"), HasSubstr("Ns/m (95 %), measured"),
                                   HasSubstr("kg (95 %), measured"), HasSubstr("effective damping"),
                                   HasSubstr("1800 samples"), Not(HasSubstr("withheld"))));
  const Estimates table(estimates_);
  const std::size_t last = table.last();
  EXPECT_NEAR(table.number("mass_kg", last), 0.25, 0.0025);
  EXPECT_NEAR(table.number("friction_Ns_m", last), 0.022, 4 * 0.006);
  EXPECT_EQ(table.text("friction_provenance", last), "measured");
  EXPECT_NEAR(table.number("friction_sd_Ns_m", last), 0.007, 0.003);
  EXPECT_EQ(table.text("friction_limit", last), "");
  EXPECT_NEAR(table.number("stiffness_N_m", last), 20, 0.5);
  // Before the model could be judged, the prior is shown, and said to be assumed.
  EXPECT_EQ(table.text("mass_provenance", 10), "assumed");
  EXPECT_EQ(table.number("mass_kg", 10), 0.25);
  EXPECT_EQ(table.text("mass_limit", 10), "too_early");
}

TEST_F(Drive, WithholdsBothWhereNobodySaysWhatItMisses) {
  const auto result = replay(recording_, {"--drive", drive_});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("the drive may miss too much of the force"),
                                   HasSubstr("0.05 Ns/m, assumed"), HasSubstr("0.25 kg, assumed")));
  const Estimates table(estimates_);
  EXPECT_EQ(table.text("friction_provenance", table.last()), "assumed");
  EXPECT_EQ(table.text("friction_limit", table.last()), "missing");
}

TEST_F(Drive, SaysWhatLimits) {
  auto late = complete_;
  late[5] = "50";
  EXPECT_THAT(replay(recording_, late).output, HasSubstr("delay, which acts like friction"));
  auto uncalibrated = complete_;
  uncalibrated[7] = "0.1";
  EXPECT_THAT(replay(recording_, uncalibrated).output, HasSubstr("the drive's gain is too large"));
  // A drive that is not the one that moved the point.
  std::string text = read_file(drive_), other = "time_s,drive_N\n";
  std::istringstream lines(text.substr(text.find('\n') + 1));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t comma = line.find(',');
    const double time_s = std::stod(line);
    other += fmt::format("{},{}\n", line.substr(0, comma),
                         std::stod(line.substr(comma + 1)) + 0.1 * std::sin(20 * time_s));
  }
  auto wrong = complete_;
  wrong[1] = folder_.write("other.csv", other);
  EXPECT_THAT(replay(recording_, wrong).output, HasSubstr("another force acts"));
}

TEST_F(Drive, IsTheSameInAColumnOrApart) {
  auto options = complete_;
  ASSERT_EQ(replay(recording_, options).exit_code, 0);
  const std::string apart = read_file(estimates_);
  options.erase(options.begin(), options.begin() + 2);
  const auto result = replay(with_column(), options);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(read_file(estimates_) == apart, true);
}

TEST_F(Drive, RefusesWhatItCannotUse) {
  const auto expect = [](const CommandResult& result, const char* words) {
    EXPECT_EQ(result.exit_code, 2) << words;
    EXPECT_THAT(result.errors, HasSubstr(words));
  };
  expect(replay(recording_, {"--drive", recording_}), "no column drive_N");
  expect(replay(with_column(), {"--drive", drive_}), "has a drive of its own");
  expect(replay(recording_, {"--drive-missing", "0"}), "has no drive that could be described");
  expect(replay(recording_, {"--drive", drive_, "--estimator", "published"}),
         "the published cascade has no such thing");
  expect(replay(recording_, {"--drive", folder_ / "none.csv"}), "none.csv");
  expect(replay(recording_, {"--drive", folder_.write("bad.csv", "time_s,drive_N\n0,x\n")}),
         "bad.csv:2");
  EXPECT_NE(replay(recording_, {"--drive", drive_, "--drive-missing", "1.5"}).exit_code, 0);
}

}  // namespace
}  // namespace condyle
