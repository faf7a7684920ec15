// SPDX-License-Identifier: Apache-2.0
// Velocity and acceleration learned from the recording, as a user of the command meets them.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "support/command.h"
#include "support/paths.h"
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

const std::string kShipped = testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");

class Learning : public testing::Test {
 protected:
  CommandResult replay(const std::string& kernels, const std::string& lag, const std::string& out) {
    std::ofstream(folder_ / "p.toml") << "[learning]\nkernels = " << kernels << '\n';
    return run_condyle(
        {"replay", kShipped, "--parameters", folder_ / "p.toml", "--lag", lag, "--out", out});
  }

  const TemporaryFolder folder_;
  const std::string plain_ = folder_ / "plain.csv", out_ = folder_ / "out.csv";
};

TEST_F(Learning, IsOnWith96KernelsUnlessTurnedOff) {
  ASSERT_EQ(run_condyle({"replay", kShipped, "--out", plain_}).exit_code, 0);
  CommandResult result = replay("96", "0", out_);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("\nlearned "));
  EXPECT_EQ(read_file(out_), read_file(plain_));
  result = replay("0", "0", out_);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, Not(HasSubstr("\nlearned ")));
  EXPECT_THAT(read_file(out_), Not(HasSubstr("velocity_learned")));
}

// Only velocity, acceleration and force change, and only where a share is not 0.
TEST_F(Learning, ShowsWhereItCorrected) {
  ASSERT_EQ(replay("0", "0", plain_).exit_code, 0);
  const CommandResult result = replay("96", "0", out_);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("\nlearned     velocity corrected by learning in 9"));
  const Table plain = read_table(plain_), learned = read_table(out_);
  ASSERT_EQ(learned.rows, plain.rows);
  const auto share = learned.numbers("velocity_learned");
  EXPECT_GT(std::count_if(share.begin(), share.end(), [](double s) { return s > 0; }), 1500);
  for (const std::string& name : plain.header) {
    const auto& before = plain.columns.at(name);
    const auto& after = learned.columns.at(name);
    if (name.starts_with("acceleration_") || name.starts_with("force_")) continue;
    if (!name.starts_with("velocity_")) {
      EXPECT_EQ(after, before) << name;
      continue;
    }
    for (std::size_t i = 0; i < plain.rows; ++i) {
      if (!(share[i] > 0)) {
        ASSERT_EQ(after[i], before[i]) << name << ' ' << i;
      }
    }
  }
}

TEST_F(Learning, IsOffWithALag) {
  ASSERT_EQ(run_condyle({"replay", kShipped, "--lag", "4", "--out", plain_}).exit_code, 0);
  const CommandResult result = replay("96", "4", out_);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(read_file(out_), read_file(plain_));
}

// A share between samples lies between theirs.
TEST_F(Learning, SharesAreResampled) {
  const CommandResult result =
      run_condyle({"replay", kShipped, "--resample-Hz", "100", "--out", out_});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto share = read_table(out_).numbers("velocity_learned");
  EXPECT_GT(std::count_if(share.begin(), share.end(), [](double s) { return s > 0; }), 2500);
}

// The velocity error of simulated chewing falls to 0.6 to 0.8 of the filter's, and the intervals
// hold at least as often.
TEST_F(Learning, IsEvaluated) {
  struct Result {
    double error, coverage;
  };
  const auto evaluate = [&](const std::string& kernels) {
    std::ofstream(folder_ / "p.toml") << "[learning]\nkernels = " << kernels << '\n';
    const CommandResult result =
        run_condyle({"evaluate", testing_support::source_path("/host_sim/scenarios/chewing.toml"),
                     "--runs", "2", "--parameters", folder_ / "p.toml", "--out", out_});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.output.find("learning with 96 kernels") != std::string::npos, kernels == "96");
    const Table table = read_table(out_);
    const auto& quantity = table.columns.at("quantity");
    const auto row = std::find(quantity.begin(), quantity.end(), "velocity") - quantity.begin();
    const auto at = [&](const char* column) {
      return table.numbers(column).at(static_cast<std::size_t>(row));
    };
    return Result{at("error_rms"), at("coverage")};
  };
  const Result plain = evaluate("0"), learned = evaluate("96");
  EXPECT_LT(learned.error, 0.85 * plain.error);
  EXPECT_GE(learned.coverage, plain.coverage);
}

TEST_F(Learning, TooManyKernelsAreRefused) {
  const CommandResult result = replay("97", "0", out_);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("p.toml:2:11: kernels = 97 is out of range; give 0 to 96"));
}

}  // namespace
}  // namespace condyle
