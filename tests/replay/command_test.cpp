// SPDX-License-Identifier: Apache-2.0
// The command as a user runs it.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <chrono>
#include <cmath>

#include "support/command.h"
#include "support/paths.h"
#include "support/table.h"
#include "support/temporary_folder.h"
#include "support/tier.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing_support::CommandResult;
using testing_support::Interrupt;
using testing_support::read_file;
using testing_support::read_table;
using testing_support::run_condyle;
using testing_support::Table;
using testing_support::TemporaryFolder;

const std::string kShipped = testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");

// Output of the program that makes recordings.
std::string make_chewing(const TemporaryFolder& folder, const std::string& duration_s) {
  const std::string path = folder / "made.csv";
  const std::string command = testing_support::program_path("make_chewing_recording") + " " +
                              duration_s + " 60 > '" + path + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return path;
}

TEST(ShippedRecording, IsWhatItsProgramMakes) {
  const TemporaryFolder folder;
  const Table shipped = read_table(kShipped), made = read_table(make_chewing(folder, "30"));
  ASSERT_EQ(shipped.rows, 1800U);
  EXPECT_EQ(shipped.columns.at("time_s"), made.columns.at("time_s"));
  const auto a = shipped.numbers("position_m"), b = made.numbers("position_m");
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i], b[i], 1.1e-9) << i;  // the last printed digit may round either way
  }
}

TEST(Replay, OfTheShippedRecordingLeavesEverything) {
  const TemporaryFolder folder;
  const std::string out = folder / "estimates.csv", figures = folder / "figures";
  const CommandResult result = run_condyle(
      {"replay", kShipped, "--estimator", "published", "--out", out, "--figures", figures});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.errors, testing::IsEmpty());
  for (const char* words :
       {"research use only", "duration    29.9833 s, 1800 samples", "rate        60 Hz",
        "gaps        0", "events      none", "innovation  0.", "mean NIS    motion 0.",
        "verdict     matched", "judges the tuning, not the subject", "(95 %), measured",
        "(95 %), derived: assumed mass", "Ns/m, assumed", "kg, assumed",
        "Friction and mass are assumed, not measured"}) {
    EXPECT_THAT(result.output, HasSubstr(words));
  }
  const Table table = read_table(out);
  EXPECT_EQ(table.rows, 1800U);
  EXPECT_EQ(table.header.size(), 19U);
  EXPECT_EQ(table.header[15], "force_provenance");
  EXPECT_EQ(table.header[18], "events");
  EXPECT_EQ(table.columns.at("force_provenance").back(), "derived");
  EXPECT_THAT(table.columns.at("friction_provenance"), testing::Each("assumed"));
  EXPECT_THAT(table.columns.at("mass_provenance"), testing::Each("assumed"));
  EXPECT_THAT(table.columns.at("events"), testing::Each(""));

  for (const char* name : {"position", "velocity", "force", "friction", "mass"}) {
    const std::string svg = read_file(figures + "/" + name + ".svg");
    EXPECT_THAT(svg, HasSubstr("research use only"));
    EXPECT_THAT(svg, HasSubstr("</svg>"));
    const bool assumed = std::string(name) == "friction" || std::string(name) == "mass";
    EXPECT_EQ(svg.find("ASSUMED: does not describe the subject") != std::string::npos, assumed)
        << name;
    EXPECT_EQ(read_file(figures + "/" + name + ".png").substr(1, 3), "PNG");
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(figures), {}), 10);
}

TEST(Replay, TwiceGivesTheSameBytes) {
  const TemporaryFolder folder;
  for (const char* run : {"1", "2"}) {
    ASSERT_EQ(run_condyle({"replay", kShipped, "--estimator", "published", "--out",
                           folder / (std::string(run) + ".csv"), "--figures", folder / run})
                  .exit_code,
              0);
  }
  EXPECT_EQ(read_file(folder / "1.csv"), read_file(folder / "2.csv"));
  for (const auto& entry : std::filesystem::directory_iterator(folder / "1")) {
    EXPECT_EQ(read_file(entry.path().string()),
              read_file((folder.path() / "2" / entry.path().filename()).string()));
  }
}

TEST(Replay, CountsFaultsAsEvents) {
  const TemporaryFolder folder;
  const std::string recording = folder.write("r.csv",
                                             "time_s,position_m\r\n0,0.001\r\n0.02,nan\r\n0.04,"
                                             "\r\n0.06,0.001\r\n0.05,0.5\r\n0.08,0.001\r\n"
                                             "0.08,0.001\r\n,0.001\r\n0.5,0.001\r\n");
  const CommandResult result = run_condyle({"replay", recording, "--estimator", "published",
                                            "--faults", "event", "--out", folder / "e.csv"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              HasSubstr("1 time_missing, 1 time_reversed, 1 time_repeated, 1 time_gap, 2 "
                        "position_missing\n"));
  EXPECT_THAT(result.output, HasSubstr("gaps        1"));
  const Table table = read_table(folder / "e.csv");
  EXPECT_THAT(table.columns.at("events"),
              testing::ElementsAre("", "position_missing", "position_missing", "", "time_reversed",
                                   "", "time_repeated", "time_missing", "time_gap"));
  EXPECT_EQ(table.columns.at("motion_nis")[1], "") << "not computed, so empty";
  EXPECT_NE(table.columns.at("position_m")[1], "") << "predicted";
  EXPECT_EQ(table.columns.at("position_m")[4], "") << "kept from the filter";
  EXPECT_EQ(table.columns.at("force_provenance")[4], "");
  EXPECT_EQ(table.columns.at("time_s")[7], "");
}

TEST(Replay, ReportsEqualTimesWithoutBeingAsked) {
  const TemporaryFolder folder;
  const std::string recording =
      folder.write("r.csv", "\xef\xbb\xbftime_s,position_m\n0,1\n0.02,1.001\n0.02,1.001\n0.04,1\n");
  const CommandResult result = run_condyle({"replay", recording, "--estimator", "published"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output, HasSubstr("events      1 time_repeated"));
  EXPECT_THAT(result.errors, HasSubstr("warning: 1 of 3 steps"));
}

TEST(Replay, WarnsWhereTheParametersSampleTimeIsNotTheRecordings) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_condyle({"replay", kShipped, "--estimator", "published", "--parameters",
                   folder.write("p.toml", "sample_time_s = 0.02\n")});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.errors, HasSubstr("warning: 1799 of 1799 steps"));
  EXPECT_THAT(result.output, HasSubstr("sample time 0.02 s"));
}

TEST(Replay, SaysWhereIntervalsCannotBeTrusted) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_condyle({"replay", kShipped, "--estimator", "published", "--parameters",
                   folder.write("p.toml",
                                "[motion]\nmeasurement_variance = [1e-10]\n"
                                "process_variance = [1e-12, 1e-8, 1e-5]\n")});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output, HasSubstr("intervals   too narrow by a factor of about"));
}

TEST(Replay, AtRealTimeTakesTheRecordingsTime) {
  const TemporaryFolder folder;
  const std::string recording =
      folder.write("r.csv", "time_s,position_m\n0,1\n0.05,1\n0.1,1\n0.15,1\n");
  const auto start = std::chrono::steady_clock::now();
  const CommandResult paced =
      run_condyle({"replay", recording, "--speed", "1", "--out", folder / "1.csv"});
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(150));
  EXPECT_EQ(paced.exit_code, 0);
  EXPECT_EQ(run_condyle({"replay", recording, "--out", folder / "0.csv"}).exit_code, 0);
  EXPECT_EQ(read_file(folder / "0.csv"), read_file(folder / "1.csv"));
}

TEST(Replay, InterruptedLeavesNothing) {
  const TemporaryFolder folder, results;
  const std::string recording = folder.write("r.csv", "time_s,position_m\n0,1\n9,1\n18,1\n");
  const CommandResult result = run_condyle({"replay", recording, "--estimator", "published",
                                            "--speed", "0.01", "--out", results / "e.csv"},
                                           {.interrupt = Interrupt::once_it_waits});
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_THAT(result.errors, HasSubstr("stopped after 1 samples; no file was left"));
  EXPECT_EQ(results.count(), 0);
}

TEST(Replay, InterruptedWhileWaitingForAPipeEnds) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  const CommandResult result =
      run_condyle({"replay", folder / "pipe"}, {.interrupt = Interrupt::once_it_waits});
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_THAT(result.errors, HasSubstr("stopped; no file was left"));
}

// Rows whose time runs backwards are left out of duration, rate and gaps.
TEST(Replay, ReversedRowsDoNotDistortTheSummary) {
  const TemporaryFolder folder;
  std::string rows;
  for (int i = 0; i < 100; ++i) {
    rows += std::to_string(i * 0.02) + ",0.001\n";
    if (i == 50) rows += "0.3,0.001\n";
  }
  const CommandResult result = run_condyle(
      {"replay", "--estimator", "published",
       folder.write("r.csv", "time_s,position_m\n" + rows + "0.1,0.001\n"), "--faults", "event"});
  EXPECT_THAT(result.output, HasSubstr("duration    1.98 s, 102 samples"));
  EXPECT_THAT(result.output, HasSubstr("rate        50 Hz on average; steps 20 to 20 ms; 0 of 99"));
  EXPECT_THAT(result.output, HasSubstr("events      2 time_reversed\n"));
  EXPECT_THAT(result.errors, testing::IsEmpty());
  const CommandResult reset = run_condyle(
      {"replay", "--estimator", "published",
       folder.write("s.csv", "time_s,position_m\n100,0.001\n" + rows), "--faults", "event"});
  EXPECT_THAT(reset.output, HasSubstr("3 time_reversed, 1 time_restarted\n"));
  EXPECT_THAT(reset.output, HasSubstr("duration    1.94 s"));
}

TEST(Replay, ClaimsNothingWhereNothingIsMeasured) {
  const TemporaryFolder folder;
  std::string rows;
  for (int i = 0; i < 200; ++i)
    rows += std::to_string(i * 0.02) + (i < 100 ? ",0.001\n" : ",nan\n");
  const CommandResult result = run_condyle({"replay", "--estimator", "published",
                                            folder.write("r.csv", "time_s,position_m\n" + rows),
                                            "--faults", "event", "--out", folder / "e.csv"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output, testing::Not(HasSubstr(", measured\n")));
  EXPECT_THAT(result.output, testing::Not(HasSubstr("derived")));
  EXPECT_EQ(read_table(folder / "e.csv").columns.at("force_provenance")[99], "derived");
  EXPECT_EQ(read_table(folder / "e.csv").columns.at("force_provenance")[100], "assumed");
}

TEST(Replay, WithoutAnyValueDrawsNothing) {
  const TemporaryFolder folder;
  const CommandResult result = run_condyle(
      {"replay", folder.write("r.csv", "time_s,position_m\n0,nan\n0.02,nan\n"), "--faults", "event",
       "--figures", folder / "a/b/figures", "--out", folder / "e.csv"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("none: no sample had a position"));
  EXPECT_THAT(result.output, HasSubstr("figures     none"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
  EXPECT_THAT(read_table(folder / "e.csv").columns.at("events"),
              testing::Each("position_missing|not_started"));
}

TEST(Replay, OfOneSampleIsComplete) {
  const TemporaryFolder folder;
  const CommandResult result = run_condyle(
      {"replay", "--estimator", "published", folder.write("r.csv", "time_s,position_m\n0,0.001\n"),
       "--parameters", folder.write("p.toml", "sample_time_s = 0.02\n"), "--figures",
       folder / "figures"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.errors, testing::IsEmpty());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "figures"), {}), 10);
}

TEST(Replay, WritesThroughALink) {
  const TemporaryFolder folder;
  const std::string target = folder.write("target.csv", "old");
  std::filesystem::create_symlink(target, folder / "link.csv");
  EXPECT_EQ(run_condyle({"replay", kShipped, "--out", folder / "link.csv"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.csv"));
  EXPECT_EQ(read_table(target).rows, 1800U);
}

TEST(Replay, EstimatesMayGoIntoTheFiguresFolder) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_condyle({"replay", kShipped, "--estimator", "published", "--out",
                         folder / "results/e.csv", "--figures", folder / "results"})
                .exit_code,
            0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "results"), {}), 11);
}

TEST(Replay, MemoryDoesNotGrowWithTheRecording) {
  if (!testing_support::command_memory_is_its_own()) {
    GTEST_SKIP() << "a sanitizer's own memory grows";
  }
  const TemporaryFolder folder;
  const auto peak_kB = [&](const std::string& duration_s) {
    const CommandResult result = run_condyle({"replay", make_chewing(folder, duration_s), "--out",
                                              "/dev/null", "--figures", folder / "figures"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return result.peak_memory_kB;
  };
  // 60 rows a second; figures are full after 100,000 rows.
  const int long_s = testing_support::runs(6000, 6000, 10'000);
  const long short_kB = peak_kB("2000"), long_kB = peak_kB(std::to_string(long_s));
  EXPECT_LT(long_kB, short_kB + 2048) << short_kB;
}

TEST(Observability, TableShowsPrintedAndCorrected) {
  const CommandResult result = run_condyle({"observability"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output,
              testing::ContainsRegex("full \\(24\\): p, v, ks, m; p; u, kv +printed +3 of 4"));
  EXPECT_THAT(result.output,
              testing::ContainsRegex("full \\(24\\): p, v, kv, m; p; u +corrected +4 of 4"));
  EXPECT_THAT(result.output,
              testing::ContainsRegex("drive unknown: [^;]*; p; - +corrected +5 of 6"));
  const CommandResult still =
      run_condyle({"observability", "--velocity-m-s", "0", "--force-N", "0"});
  EXPECT_THAT(still.output, testing::ContainsRegex("corrected +2 of 3 .*NOT observable"));
  EXPECT_THAT(still.output, HasSubstr("v = 0 m/s"));
  // Acceleration zero up to rounding.
  const CommandResult rounded =
      run_condyle({"observability", "--velocity-m-s", "0.1", "--friction-Ns-m", "0.7", "--force-N",
                   "0.07", "--force-rate-N-s", "0"});
  EXPECT_THAT(rounded.output, testing::ContainsRegex("corrected +2 of 3 +0 +inf +NOT observable"));
  EXPECT_THAT(rounded.output, testing::ContainsRegex("corrected +3 of 4 +0 +inf +NOT observable"));
}

TEST(Command, TellsItsVersionAndHelp) {
  EXPECT_THAT(run_condyle({"--version"}).output, HasSubstr("condyle 0.1.0"));
  const CommandResult help = run_condyle({"replay", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* option :
       {"--estimator", "--parameters", "--point", "--axis", "--faults", "--ignore-column",
        "--speed", "--lag", "--out", "--figures", "--unit"}) {
    EXPECT_THAT(help.output, HasSubstr(option));
  }
}

}  // namespace
}  // namespace condyle
