// SPDX-License-Identifier: Apache-2.0
// Velocity and acceleration learned from the recording, as a user of the command meets them.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "condyle/hal/log/session_log.h"
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

// The teacher of 60 Hz is three samples late.
TEST_F(Learning, CorrectsLagsBelowTheTeachers) {
  for (const char* const lag : {"1", "3"}) {
    ASSERT_EQ(replay("0", lag, plain_).exit_code, 0);
    const CommandResult result = replay("96", lag, out_);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const bool is_below = lag == std::string("1");
    EXPECT_THAT(result.output, HasSubstr(is_below ? "\nlearned     velocity corrected"
                                                  : "\nlearned     nothing: the lag is not below"));
    const auto filtered = read_table(plain_).numbers("velocity_m_s");
    const auto learned = read_table(out_).numbers("velocity_m_s");
    const auto share = read_table(out_).numbers("velocity_learned");
    std::size_t corrected = 0;
    for (std::size_t i = 0; i < share.size(); ++i) {
      if (share[i] > 0) ++corrected;
      if (!(share[i] > 0) && std::isfinite(filtered[i])) {
        EXPECT_EQ(learned[i], filtered[i]) << i;
      }
    }
    EXPECT_EQ(corrected > share.size() / 2, is_below) << corrected;
  }
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

// The same subject on another day: the first seconds are better with what the day before taught.
TEST_F(Learning, BeginsWithAnEarlierRecording) {
  const std::string scenario = testing_support::source_path("/host_sim/scenarios/chewing.toml");
  const std::string kept = folder_ / "learned.json", truth = folder_ / "truth.csv";
  for (const char* seed : {"1", "2"}) {
    ASSERT_EQ(run_condyle({"simulate", scenario, "--seed", seed, "--out",
                           folder_ / (std::string(seed) + ".csv"), "--truth", truth})
                  .exit_code,
              0);
  }
  CommandResult result = run_condyle({"replay", folder_ / "1.csv", "--learned-out", kept});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("learned     " + kept));
  ASSERT_EQ(run_condyle({"replay", folder_ / "2.csv", "--out", plain_}).exit_code, 0);
  result = run_condyle({"replay", folder_ / "2.csv", "--learned", kept, "--out", out_});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Table true_motion = read_table(truth);
  const auto error = [&](const std::string& file) {
    const Table table = read_table(file);
    const auto time_s = table.numbers("time_s"), said = table.numbers("velocity_m_s");
    const auto true_m_s = true_motion.numbers("velocity_m_s");
    double sum = 0;
    for (std::size_t i = 0; i < table.rows; ++i) {
      if (time_s[i] - time_s[0] > 2 && time_s[i] - time_s[0] < 10) {
        sum += std::pow(said[i] - true_m_s[i], 2);
      }
    }
    return std::sqrt(sum);
  };
  EXPECT_LT(error(out_), 0.95 * error(plain_));
}

TEST_F(Learning, BeginsWithWhatASessionLogKeeps) {
  const std::string kept = folder_ / "learned.json", log_path = folder_ / "log.mcap";
  ASSERT_EQ(run_condyle({"replay", kShipped, "--learned-out", kept}).exit_code, 0);
  hal::SessionHeader header;
  header.software_version = "test";
  header.sources = {{.name = "facebow",
                     .profile_toml = read_file(
                         testing_support::source_path("/hal/profiles/condyle_facebow.toml")),
                     .report_descriptor = {}}};
  hal::SessionLogWriter log;
  ASSERT_EQ(log.open(log_path, header), hal::SessionLogFailure::none);
  ASSERT_TRUE(log.keep_learned(read_file(kept)));
  ASSERT_EQ(log.close(), hal::SessionLogFailure::none);
  ASSERT_EQ(run_condyle({"replay", kShipped, "--learned", kept, "--out", plain_}).exit_code, 0);
  const CommandResult result =
      run_condyle({"replay", kShipped, "--learned", log_path, "--out", out_});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(read_file(out_) == read_file(plain_), true);
}

TEST_F(Learning, RefusesWhatItCannotBeginWith) {
  const std::string kept = folder_ / "learned.json";
  const auto refused = [&](const std::vector<std::string>& more, const char* words) {
    std::vector<std::string> arguments = {"replay", kShipped, "--out", out_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = run_condyle(arguments);
    EXPECT_EQ(result.exit_code, 2) << words;
    EXPECT_THAT(result.errors, HasSubstr(words));
    EXPECT_FALSE(std::filesystem::exists(out_)) << words;
  };
  ASSERT_EQ(run_condyle({"replay", kShipped, "--learned-out", kept}).exit_code, 0);
  const auto write = [&](const std::string& text) {
    std::ofstream(folder_ / "bad.json") << text;
    return std::vector<std::string>{"--learned", folder_ / "bad.json"};
  };
  refused({"--learned", kept, "--lag", "1"}, "was learned with a lag of 0 samples, and this");
  refused({"--learned", kept, "--lag", "16"}, "--learned: needs learning; give no lag of 16");
  refused({"--learned-out", folder_ / "l.json", "--estimator", "published"},
          "--learned-out: needs learning");
  refused({"--learned", folder_ / "absent.json"}, "absent.json");
  std::ofstream(folder_ / "cut.mcap") << "\x89MCAP0\r\n";
  refused({"--learned", folder_ / "cut.mcap"}, "cut.mcap: does not hold what a session has taught");
  refused(write("{}"),
          "does not hold what a recording has taught; give a session log, or a file "
          "that --learned-out");
  refused(write("not JSON"), "does not hold what a recording has taught");
  refused(write(R"({"format": "other"})"), "is not of format condyle-learned-1");
  const std::string text = read_file(kept);
  const auto spoilt = [&](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return write(text.substr(0, at) + to + text.substr(at + from.size()));
  };
  refused(spoilt("\"kernels\":", "\"kernels\":9"), "kernels; give [learning] kernels = ");
  refused(spoilt("\"squares\":[", "\"squares\":[1,"), "has 3 values of squares, not 2");
  refused(spoilt("\"squares\":[", "\"squares\":[-"), "squares that is not above 0");
  refused(spoilt("\"covariance\":[", "\"covariance\":[-"), "a variance that is not above 0");
  refused(spoilt("\"use\":[", "\"use\":[1e9,"), " values of use, not ");
  std::ofstream(folder_ / "points.csv") << "time_s,p1_x_mm,p1_y_mm,p1_z_mm\n0,0,0,1\n0.016,0,0,2\n";
  CommandResult result = run_condyle({"replay", folder_ / "points.csv", "--learned", kept});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("was learned along 1 axes, and this recording has 3"));
  std::string rows = "time_s,position_mm\n";
  for (int i = 0; i < 100; ++i) rows += std::to_string(i * 0.005) + ",1\n";
  std::ofstream(folder_ / "fast.csv") << rows;
  result = run_condyle({"replay", folder_ / "fast.csv", "--learned", kept});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("Hz, and this recording has 200 Hz; learn from"));
}

TEST_F(Learning, TooManyKernelsAreRefused) {
  const CommandResult result = replay("97", "0", out_);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("p.toml:2:11: kernels = 97 is out of range; give 0 to 96"));
}

}  // namespace
}  // namespace condyle
