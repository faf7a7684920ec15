// SPDX-License-Identifier: Apache-2.0
// replay with a measured drive: what it shows of friction and mass, and what it withholds.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

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
  // With each row of the drive changed by `change(time_s, drive_N)`.
  template <class Change>
  CommandResult replay_changed(const Change& change) {
    std::string text = "time_s,drive_N\n";
    std::istringstream lines(read_file(drive_));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      double time_s = std::stod(line), drive_N = std::stod(line.substr(line.find(',') + 1));
      change(time_s, drive_N);
      text += fmt::format("{},{}\n", time_s, drive_N);
    }
    auto options = complete_;
    options[1] = folder_.write("changed.csv", text);
    return replay(recording_, options);
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
  EXPECT_THAT(replay_changed([](double& time_s, double& drive_N) {
                drive_N += 0.1 * std::sin(20 * time_s);
              }).output,
              HasSubstr("another force acts"));
}

TEST_F(Drive, NoticesUnitsThatCannotBe) {
  const auto scaled = [&](double factor) {
    return replay_changed([factor](double&, double& drive_N) { drive_N *= factor; }).output;
  };
  const auto withheld = AllOf(HasSubstr("0.05 Ns/m, assumed"), HasSubstr("0.25 kg, assumed"));
  EXPECT_THAT(scaled(1e-3), AllOf(withheld, HasSubstr("if the drive is in kN, it would be 0.25 kg"),
                                  HasSubstr("1.1e-05 N, unusual for a sensor")));
  EXPECT_THAT(scaled(1 / 9.80665), AllOf(withheld, HasSubstr("if the drive is in kgf")));
  EXPECT_THAT(scaled(1e3), AllOf(withheld, HasSubstr("if the drive is in mN")));
  EXPECT_THAT(scaled(-1), AllOf(withheld, HasSubstr("the sign of the drive or of the axis")));
  // The motion cannot tell: what the values rest on is said.
  EXPECT_THAT(scaled(0.2),
              AllOf(HasSubstr("few jaws have such a mass"), HasSubstr("assumes     drive in N")));
  auto stated = complete_;
  stated.insert(stated.end(), {"--drive-noise-N", "0.1"});
  EXPECT_THAT(replay(recording_, stated).output, HasSubstr("0.011 N, 0.1 N was stated"));
}

TEST_F(Drive, WidensByWhatIsStatedOfScaleAndAngle) {
  auto stated = complete_;
  stated.insert(stated.end(), {"--position-scale-sd", "0.1"});
  EXPECT_THAT(replay(recording_, stated).output, HasSubstr("the drive's gain is too large"));
  stated[stated.size() - 2] = "--drive-angle-sd-deg";
  stated.back() = "20";
  EXPECT_THAT(replay(recording_, stated).output, HasSubstr("the drive's gain is too large"));
}

TEST_F(Drive, IsNotTakenOnAnotherClock) {
  const auto apart = replay_changed([](double& time_s, double&) { time_s += 1000; });
  EXPECT_EQ(apart.exit_code, 2);
  EXPECT_THAT(apart.errors, AllOf(HasSubstr("it covers 1000 to 1029.98 s, the recording 0 to"),
                                  HasSubstr("no time in common")));
  EXPECT_THAT(replay_changed([](double& time_s, double&) { time_s += 10; }).output,
              HasSubstr("drive: it covers 10 to 39.9833 s, the recording 0 to"));
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
  expect(replay(recording_, {"--drive-missing", "0"}),
         "has no drive, so options of the drive do not apply");
  expect(replay(recording_, {"--drive", drive_, "--estimator", "published"}),
         "is not supported by --estimator published");
  expect(replay(recording_, {"--drive", folder_ / "none.csv"}), "none.csv");
  expect(replay(recording_, {"--drive", folder_.write("bad.csv", "time_s,drive_N\n0,x\n")}),
         "bad.csv:2");
  EXPECT_NE(replay(recording_, {"--drive", drive_, "--drive-missing", "1.5"}).exit_code, 0);
}

}  // namespace
}  // namespace condyle
