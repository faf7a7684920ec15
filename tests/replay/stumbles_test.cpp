// SPDX-License-Identifier: Apache-2.0
// What a newcomer stumbles over: standard output as a file, recordings that say nothing.
#include <gmock/gmock.h>

#include <cmath>

#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::source_path;
using testing_support::TemporaryFolder;

const std::string kShipped = source_path("/host_sim/recordings/chewing_60hz.csv");

TEST(StandardOutput, TakesTheRowsAndNothingElse) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.csv";
  ASSERT_EQ(run_condyle({"replay", kShipped, "--out", out}).exit_code, 0);
  const CommandResult result = run_condyle({"replay", kShipped, "--out", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.output, read_file(out));
  EXPECT_THAT(result.errors, HasSubstr("estimates   -"));
  EXPECT_THAT(result.errors, HasSubstr("duration    29.9833 s, 1800 samples"));
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST(StandardOutput, TakesOneFileOnly) {
  const TemporaryFolder folder;
  const std::string scenario = source_path("/host_sim/scenarios/point_mass.toml");
  const CommandResult both = run_condyle({"simulate", scenario, "--out", "-", "--truth", "-"});
  EXPECT_EQ(both.exit_code, 2);
  const CommandResult beside = run_condyle({"simulate", scenario, "--out", "-"});
  EXPECT_EQ(beside.exit_code, 2);
  EXPECT_THAT(beside.errors,
              HasSubstr("--out -: the scenario also writes drive, EMG or head motion"));
  const CommandResult log = run_condyle(
      {"record", "--profile", source_path("/hal/profiles/condyle_facebow.toml"), "--out", "-"});
  EXPECT_EQ(log.exit_code, 2);
  EXPECT_THAT(log.errors, HasSubstr("--out -: a session log cannot go to standard output"));
  const CommandResult full =
      run_condyle({"replay", kShipped, "--out", "-"}, {.output_to = "/dev/full"});
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_THAT(full.errors, HasSubstr("standard output: cannot be written: No space left"));
}

// Its files are there by then, although Ctrl-C came before.
TEST(StandardOutput, SaysThatItCannotBeWrittenIfFilesWereLeft) {
  const TemporaryFolder folder;
  const std::string out = folder / "jaw.csv";
  const CommandResult result = run_condyle(
      {"simulate", source_path("/host_sim/scenarios/clinical_session.toml"), "--out", out},
      {.interrupt = testing_support::Interrupt::once_it_can_be, .output_to = "/dev/full"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("standard output: cannot be written"));
  EXPECT_TRUE(std::filesystem::exists(out));
}

// `count` rows of a sine; the time stands still after `moving` rows.
std::string rows(int count, double amplitude_m, int moving) {
  std::string text = "time_s,position_m\n";
  for (int i = 0; i < count; ++i) {
    text += std::to_string(0.01 * std::min(i, moving)) + "," +
            std::to_string(0.005 + amplitude_m * std::sin(0.1 * i)) + "\n";
  }
  return text;
}

TEST(Recordings, ThatSayNothingAreNamedSoInOneSentence) {
  struct Case {
    std::string rows;
    const char* words;
  };
  const Case cases[] = {
      {rows(1, 0.005, 1), "1 of its samples has a position, and a velocity takes 3 at least"},
      {rows(2, 0.005, 2), "2 of its samples have a position, and a velocity takes 3 at least"},
      {rows(500, 0, 500), "positions are the same, which a real instrument does not measure"},
      {rows(900, 0.005, 300), "599 of 900 samples have the time of the sample before"},
  };
  const TemporaryFolder folder;
  const std::string parameters = folder.write("p.toml", "sample_time_s = 0.01\n");
  const std::string none = folder.write("none.toml", "");
  for (const Case& one : cases) {
    const std::string path = folder.write("r.csv", one.rows);
    for (const std::string estimator : {"recommended", "published"}) {
      const CommandResult result =
          run_condyle({"replay", path, "--estimator", estimator, "--parameters",
                       estimator == "published" ? parameters : none});
      EXPECT_EQ(result.exit_code, 0) << result.errors;
      EXPECT_THAT(result.output, AllOf(HasSubstr("unusable    "), HasSubstr(one.words)))
          << estimator;
      for (const char* words : {"mean NIS", "last values", "consistency", "verdict", "noise "}) {
        EXPECT_THAT(result.output, Not(HasSubstr(words))) << estimator;
      }
      EXPECT_EQ(result.errors, "") << estimator;
    }
  }
  const CommandResult three =
      run_condyle({"replay", folder.write("r.csv", rows(3, 0.005, 3)), "--parameters", none});
  EXPECT_THAT(three.output, Not(HasSubstr("unusable")));
}

TEST(Recordings, ShowNoNumbersFarBelowTheirIntervals) {
  std::string text = "time_s,position_m\n";
  for (int i = 0; i < 400; ++i) {
    text += std::to_string(0.01 * i) + "," + (i % 2 == 0 ? "1e-45" : "-1e-45") + "\n";
  }
  const TemporaryFolder folder;
  const CommandResult result = run_condyle({"replay", folder.write("r.csv", text)});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("  position  0 +- "));
  EXPECT_THAT(result.output.substr(result.output.find("last values")), Not(HasSubstr("e-4")));
}

// Two instruments, one noise: too much for one and too little for the other.
TEST(Instruments, ThatDifferAreNoticedByTune) {
  const TemporaryFolder folder;
  const auto simulated = [&](const std::string& name, const char* noise_m) {
    const std::string scenario = folder.write(
        name + ".toml",
        "duration_s = 20\n[subject]\nmotion = \"hinge\"\n[facebow]\nrate_Hz = 100\ngives = "
        "\"axis\"\nnoise_m = " +
            std::string(noise_m) + "\n");
    const std::string path = folder / (name + ".csv");
    const CommandResult made = run_condyle({"simulate", scenario, "--out", path});
    EXPECT_EQ(made.exit_code, 0) << made.errors;
    return path;
  };
  const std::string fine = simulated("fine", "3e-5"), coarse = simulated("coarse", "3e-4");
  const std::string out = folder / "tuned.toml";
  const CommandResult result = run_condyle({"tune", fine, coarse, "--out", out, "--starts", "2"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("OUTSIDE its own bounds in 2 of 2 recordings"));
  EXPECT_THAT(result.output, HasSubstr("tune each instrument alone"));
}

}  // namespace
}  // namespace condyle
