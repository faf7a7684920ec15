// SPDX-License-Identifier: Apache-2.0
// tune: what it writes and says by either criterion, and what it refuses.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "hosted/config/parameter_file.h"
#include "statistics/random.h"
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
using testing_support::reference_data;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

const std::string kShipped = testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");

class Tune : public testing::Test {
 protected:
  // `condyle tune RECORDINGS --out p.toml MORE`
  CommandResult tune(std::vector<std::string> recordings,
                     const std::vector<std::string>& more = {}) {
    recordings.insert(recordings.begin(), "tune");
    recordings.insert(recordings.end(), {"--out", out_});
    recordings.insert(recordings.end(), more.begin(), more.end());
    return run_condyle(recordings);
  }
  // A movement of 1.3 Hz with white noise, each position the mean of `averaged`.
  std::string record(const std::string& name, std::size_t averaged, double noise_mm = 0.1) {
    host::RandomGenerator random(7);
    std::string text = "time_s,position_mm\n";
    std::vector<double> measured_mm;
    for (std::size_t k = 0; k < 3000; ++k) {
      const double t = 0.005 * static_cast<double>(k);
      measured_mm.push_back(8 * std::sin(8.17 * t) + 2 * std::sin(5.1 * t + 0.4 * std::sin(t)) +
                            noise_mm * random.normal());
      if (k + 1 < averaged) continue;
      double sum = 0;
      for (std::size_t i = 0; i < averaged; ++i) sum += measured_mm[k - i];
      text += fmt::format("{:.3f},{:.7f}\n", t, sum / static_cast<double>(averaged));
    }
    return folder_.write(name, text);
  }

  // Of the shipped recording.
  static std::string first_rows(int count) {
    const std::string all = read_file(kShipped);
    std::size_t end = 0;
    for (int line = 0; line < count + 1; ++line) end = all.find('\n', end) + 1;
    return all.substr(0, end);
  }

  TemporaryFolder folder_;
  std::string out_ = folder_ / "p.toml";
};

TEST_F(Tune, WritesParametersThatReplayTakes) {
  const std::string recording = folder_.write("r.csv", first_rows(720));
  const CommandResult result = tune({recording}, {"--figures", folder_ / "figures"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("research use only"), HasSubstr("720 used of 720 samples"),
                    HasSubstr("12 of 12 starts"), HasSubstr("held out"), HasSubstr("tuning.png")));
  const auto parameters = host::load_recommended_parameters(out_);
  EXPECT_EQ(parameters.noise.adaptation, Adaptation::off);
  // The recording's noise is 0.1 mm.
  EXPECT_NEAR(parameters.noise.position_sd_m, 1e-4, 0.1e-4);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "figures/tuning.svg"));
  const CommandResult replayed = run_condyle({"replay", kShipped, "--parameters", out_});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.errors;
}

TEST_F(Tune, IsTheSameEachTimeAndTheSameForItsOwnResult) {
  ASSERT_EQ(tune({kShipped}, {"--starts", "4"}).exit_code, 0);
  const std::string first = read_file(out_);
  ASSERT_EQ(tune({kShipped}, {"--starts", "4"}).exit_code, 0);
  EXPECT_EQ(read_file(out_), first);
  std::filesystem::rename(out_, folder_ / "first.toml");
  ASSERT_EQ(tune({kShipped}, {"--parameters", folder_ / "first.toml", "--seed", "9"}).exit_code, 0);
  const auto again = host::load_recommended_parameters(out_);
  const auto before = host::load_recommended_parameters(folder_ / "first.toml");
  EXPECT_NEAR(again.noise.position_sd_m / before.noise.position_sd_m, 1, 1e-3);
  EXPECT_NEAR(again.noise.jerk_density_m2_s5 / before.noise.jerk_density_m2_s5, 1, 2e-3);
}

TEST_F(Tune, KeepsWhatItDoesNotTune) {
  const std::string start = folder_.write(
      "start.toml",
      "assumed_mass_kg = 0.4\n[outliers]\ngate_sd = 8\n[drive]\ndelay = \"fitted\"\n");
  ASSERT_EQ(tune({kShipped}, {"--parameters", start}).exit_code, 0);
  const auto parameters = host::load_recommended_parameters(out_);
  EXPECT_EQ(parameters.assumed_mass_kg, 0.4);
  EXPECT_EQ(parameters.outliers.gate_sd, 8);
  EXPECT_EQ(parameters.impedance.delay, DelayModel::fitted);
}

TEST_F(Tune, SaysThatTheMakerSmoothedAndWhatServesThen) {
  const CommandResult result = tune({record("smoothed.csv", 3)}, {"--starts", "2"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("NOT WHITE"), HasSubstr("smoothed before recording"),
                    HasSubstr("if the noise were white, which it is not"), HasSubstr("stand-in")));
  EXPECT_THAT(read_file(out_), HasSubstr("The noise is not white"));
  EXPECT_THAT(tune({record("white.csv", 1)}, {"--starts", "1"}).output,
              Not(HasSubstr("NOT WHITE")));
}

// Without noise the noise is at its bound, and the file is one that replay takes all the same.
TEST_F(Tune, WritesWhatReplayTakesWhereTheNoiseIsAtItsBound) {
  const std::string recording = record("still.csv", 1, 0);
  const CommandResult result = tune({recording}, {"--starts", "2"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("NOT known"), Not(HasSubstr("nan"))));
  const CommandResult replayed = run_condyle({"replay", recording, "--parameters", out_});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.errors;
}

TEST_F(Tune, KeepsTheNamesOfFilesOutOfTheParameters) {
  for (const char* name : {"smoothed\n[drive]\ndelay_s = 0.5 #.csv", "smoothed\xfc.csv"}) {
    ASSERT_EQ(tune({record(name, 3)}, {"--starts", "1"}).exit_code, 0);
    EXPECT_EQ(host::load_recommended_parameters(out_).impedance.drive.delay_s, 0) << name;
  }
}

TEST_F(Tune, SaysThatAValueAtItsBoundIsNotKnown) {
  const CommandResult result = tune({kShipped}, {"--noise-bounds-mm", "0.2", "1"});
  EXPECT_THAT(result.output, HasSubstr("at its bound, so it is NOT known"));
}

TEST_F(Tune, TakesAHundredRecordingsInBoundedMemory) {
  if (!testing_support::command_memory_is_its_own()) {
    GTEST_SKIP() << "a sanitizer's own memory grows";
  }
  const std::string some = first_rows(400);
  std::vector<std::string> hundred;
  for (int i = 0; i < 100; ++i) {
    hundred.push_back(folder_.write(fmt::format("{}.csv", i), some));
  }
  const CommandResult single = tune({hundred[0]}), many = tune(hundred, {"--starts", "1"});
  ASSERT_EQ(many.exit_code, 0) << many.errors;
  EXPECT_THAT(many.output, AllOf(HasSubstr("and 92 more"), HasSubstr("40000 used of 40000")));
  EXPECT_LT(many.peak_memory_kB - single.peak_memory_kB, 40'000);
  EXPECT_THAT(tune(hundred, {"--most-samples", "10000"}).errors,
              HasSubstr("10000 are too few for 100 recordings; give 102400 or more"));
}

TEST_F(Tune, KeepsAsManySamplesAsItIsTold) {
  const std::string copy = folder_.write("copy.csv", read_file(kShipped));
  const CommandResult result = tune({kShipped, copy}, {"--starts", "1", "--most-samples", "2048"});
  EXPECT_THAT(result.output, HasSubstr("2048 samples were kept, evenly spread"));
}

TEST_F(Tune, ByThePublishedCriterionListsTuningsThatItCannotTellApart) {
  const std::string tunings = folder_ / "tunings.csv";
  const CommandResult result = tune({kShipped}, {"--criterion", "published", "--tunings", tunings,
                                                 "--figures", folder_ / "figures"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("does not distinguish these tunings"),
                                   HasSubstr("ASSUMED"), HasSubstr("published_tunings.png")));
  const auto table = testing_support::read_table(tunings);
  ASSERT_GE(table.rows, 5U);
  const auto friction = table.numbers("friction_Ns_m");
  const auto [lowest, highest] = std::minmax_element(friction.begin(), friction.end());
  EXPECT_GT(*highest / *lowest, 3);
  const CommandResult replayed =
      run_condyle({"replay", kShipped, "--estimator", "published", "--parameters", out_});
  EXPECT_THAT(replayed.output, HasSubstr("verdict     matched"));
}

TEST_F(Tune, ByThePublishedCriterionLeavesNoFileWhereNothingSatisfiesIt) {
  // A mass that starts near its own, far from m0, and may hardly change.
  const std::string start =
      folder_.write("start.toml",
                    "[mass]\ninitial_kg = 0.1\ninitial_variance = [1e-6, 0.01, 1e-20]\n"
                    "process_variance = [1e-12, 1e-8, 1e-25]\n");
  const CommandResult result =
      tune({kShipped}, {"--criterion", "published", "--parameters", start, "--starts", "3"});
  EXPECT_EQ(result.exit_code, 3) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("NOT SATISFIED"));
  EXPECT_FALSE(std::filesystem::exists(out_));
}

TEST_F(Tune, RefusesBadInputAndLeavesNoFile) {
  const std::string constant = [&] {
    std::string text = "time_s,position_m\n";
    for (int i = 0; i < 1000; ++i) text += fmt::format("{:.2f},0.01\n", 0.01 * i);
    return folder_.write("constant.csv", text);
  }();
  const std::string two = folder_.write("two.csv", "time_s,position_m\n0,0\n0.01,0.001\n");
  const std::string nan = [&] {
    std::string text = "time_s,position_m\n";
    for (int i = 0; i < 1000; ++i) text += fmt::format("{:.2f},nan\n", 0.01 * i);
    return folder_.write("nan.csv", text);
  }();
  const auto refused = [&](const std::vector<std::string>& recordings,
                           const std::vector<std::string>& more, const std::string& words) {
    const CommandResult result = tune(recordings, more);
    EXPECT_EQ(result.exit_code, 2) << words << result.output;
    EXPECT_THAT(result.errors, HasSubstr(words));
    EXPECT_FALSE(std::filesystem::exists(out_));
  };
  for (const char* criterion : {"likelihood", "published"}) {
    const std::vector<std::string> by = {"--criterion", criterion};
    refused({constant}, by, "never changes");
    refused({nan}, by, "nan.csv");
    refused({folder_ / "absent.csv"}, by, "absent.csv");
    refused({kShipped, constant}, by, "constant.csv");
    refused({kShipped}, {"--criterion", criterion, "--axis", "x"}, "has one axis");
  }
  refused({two}, {}, "has 2 usable positions");
  // Bursts too short for a filter to settle.
  std::string bursts = "time_s,position_m\n";
  for (int i = 0; i < 1500; ++i) {
    bursts += fmt::format("{:.3f},{:.6f}\n", 0.01 * i + i / 15, 1e-3 * std::sin(0.3 * i));
  }
  refused({folder_.write("bursts.csv", bursts)}, {}, "0 in runs long enough");
  refused({two}, {"--criterion", "published"}, "has 2 measured positions");
  refused({nan}, {"--faults", "event"}, "always missing");
  refused({kShipped, kShipped}, {}, "is given twice");
  refused({kShipped}, {"--noise-bounds-mm", "1", "0.1"}, "is not below the upper");
  refused({kShipped}, {"--jerk-density-bounds", "5", "5"}, "is not below the upper");
  refused({kShipped}, {"--noise-bounds-mm", "nan", "1"}, "is not a number");
  refused({kShipped}, {"--tunings", folder_ / "t.csv"}, "is not supported by the criterion");
  refused({kShipped}, {"--criterion", "published", "--jerk-density-bounds", "1", "2"},
          "is not supported by the criterion");
  refused({kShipped},
          {"--parameters", testing_support::source_path("/host_sim/recordings/chewing_60hz.toml")},
          "published");
  EXPECT_EQ(run_condyle({"tune", kShipped, "--out", kShipped}).exit_code, 2);
}

// Held-out innovations are as expected, or it says why no white noise explains them.
TEST_F(Tune, OfRealRecordingsSaysWhetherWhiteNoiseServes) {
  if (reference_data("zebris_jma/JMA_position.txt").empty()) {
    GTEST_SKIP() << "set CONDYLE_REFERENCE_DATA to the folder of reference data";
  }
  for (const char* name :
       {"zebris_jma/JMA_position.txt", "jaws3d/jawPosition.txt", "ema_jaw/0020.jaw"}) {
    const CommandResult result = tune({reference_data(name)}, {"--starts", "2"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    if (result.output.find(", inside the 95 % bounds") == std::string::npos) {
      EXPECT_THAT(result.output, HasSubstr("  against it  ")) << name;
    }
    std::cout << result.output;
  }
}

}  // namespace
}  // namespace condyle
