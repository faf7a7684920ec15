// SPDX-License-Identifier: Apache-2.0
// compare: estimators on the same recordings.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "replay/compare_fixture.h"
#include "support/command.h"
#include "support/paths.h"
#include "support/table.h"
#include "support/tier.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::read_table;
using testing_support::run_condyle;
using testing_support::Table;

const std::string kCompared = testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");

class CompareEstimators : public testing_support::CompareTest {};

TEST_F(CompareEstimators, EstimatorsOnTheShippedRecording) {
  const std::string out = folder_ / "table.csv";
  const CommandResult result =
      run_condyle({"compare", kCompared, "--out", out, "--figures", folder_ / "figures"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("research use only"), HasSubstr("recommended"),
                                   HasSubstr("Ns/m, assumed, no finding"),
                                   HasSubstr("one in 20 differs by chance"),
                                   HasSubstr("their differences do not describe the subject"),
                                   Not(HasSubstr(", measured"))));
  const Table table = read_table(out);
  ASSERT_EQ(table.rows, 2U);
  EXPECT_EQ(table.columns.at("estimator")[1], "published");
  EXPECT_EQ(table.numbers("samples")[0], 1800);
  EXPECT_EQ(table.numbers("log_score_difference")[0], 0);
  EXPECT_EQ(table.numbers("velocity_difference_rms_mm_s")[0], 0);
  EXPECT_GT(table.numbers("velocity_difference_rms_mm_s")[1], 1);
  EXPECT_LT(table.numbers("log_score_difference_high")[1], 0);
  EXPECT_EQ(table.columns.at("friction_provenance")[0], "");
  EXPECT_EQ(table.columns.at("friction_provenance")[1], "assumed");
  EXPECT_EQ(table.columns.at("friction_sd_Ns_m")[1], "") << "it would be that of the tuning";
  EXPECT_EQ(table.columns.at("noise_sd_mm")[1], "");
  EXPECT_EQ(table.columns.at("warning")[0], "none");
  EXPECT_NEAR(table.numbers("noise_sd_mm")[0], 0.1, 0.01);  // of the recording
  EXPECT_THAT(read_file(folder_ / "figures/estimators.svg"),
              AllOf(HasSubstr("research use only"), HasSubstr("mean NIS"), HasSubstr("</svg>")));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "figures/estimators.png"));
}

// What compare says of a run is what replay's rows say.
TEST_F(CompareEstimators, AgreesWithReplay) {
  for (const char* estimator : {"recommended", "published"}) {
    const std::string out = folder_ / "table.csv", rows = folder_ / "rows.csv";
    ASSERT_EQ(run_condyle({"compare", kCompared, "--with", estimator, "--out", out}).exit_code, 0);
    ASSERT_EQ(run_condyle({"replay", kCompared, "--estimator", estimator, "--out", rows}).exit_code,
              0);
    const Table table = read_table(out), replayed = read_table(rows);
    const auto nis = replayed.numbers("motion_nis"), velocity = replayed.numbers("velocity_m_s");
    const auto position = replayed.numbers("position_m");
    double nis_sum = 0, velocity_squares = 0, lowest = 1, highest = -1;
    int nis_count = 0, measured = 0;
    for (std::size_t i = 0; i < replayed.rows; ++i) {
      if (std::isfinite(nis[i])) {
        nis_sum += nis[i];
        ++nis_count;
      }
      // The published cascade measures from its first update on.
      const bool is_measured = replayed.columns.count("velocity_provenance") == 0
                                   ? i > 0
                                   : replayed.columns.at("velocity_provenance")[i] == "measured";
      if (!is_measured) continue;
      velocity_squares += velocity[i] * velocity[i];
      ++measured;
      lowest = std::min(lowest, position[i]);
      highest = std::max(highest, position[i]);
    }
    EXPECT_EQ(table.numbers("nis_samples")[0], nis_count) << estimator;
    EXPECT_NEAR(table.numbers("mean_nis")[0], nis_sum / nis_count, 1e-9);
    EXPECT_NEAR(table.numbers("measured_share")[0], measured / 1800.0, 1e-12);
    EXPECT_NEAR(table.numbers("velocity_rms_mm_s")[0], 1e3 * std::sqrt(velocity_squares / measured),
                1e-9);
    EXPECT_NEAR(table.numbers("range_mm")[0], 1e3 * (highest - lowest), 0.5);
  }
}

// The assumed mass moves no motion, and a lag sees the same samples.
TEST_F(CompareEstimators, TheSameEstimatorDiffersByNothing) {
  const std::string heavy = folder_.write("heavy.toml", "assumed_mass_kg = 0.5\n");
  const std::string out = folder_ / "table.csv";
  for (const char* lag : {"0", "5"}) {
    const CommandResult result =
        run_condyle({"compare", kCompared, record(1), "--with", "recommended", "--with",
                     "recommended:" + heavy, "--with", "published", "--lag", lag, "--out", out});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_THAT(result.output, HasSubstr("no detectable difference"));
    const Table table = read_table(out);
    ASSERT_EQ(table.rows, 6U);
    for (const std::size_t row : {1U, 4U}) {
      EXPECT_EQ(table.numbers("log_score_difference")[row], 0);
      EXPECT_EQ(table.numbers("log_score_difference_high")[row], 0);
      EXPECT_EQ(table.numbers("velocity_difference_rms_mm_s")[row], 0);
      EXPECT_GT(table.numbers("velocity_difference_rms_mm_s")[row + 1], 1);
    }
  }
}

// Later samples improve the velocity, so that it comes nearer to another's with them: rows of one
// instant are compared whatever the lag.
TEST_F(CompareEstimators, RowsOfOneInstantAreCompared) {
  const std::string out = folder_ / "table.csv";
  const auto difference = [&](const char* lag) {
    EXPECT_EQ(run_condyle({"compare", kCompared, "--lag", lag, "--out", out}).exit_code, 0);
    EXPECT_EQ(read_table(out).numbers("predicted_by_all")[0], 1799);
    return read_table(out).numbers("velocity_difference_rms_mm_s")[1];
  };
  // Five samples apart, the velocities would differ by some 30 mm/s.
  EXPECT_LT(difference("5"), 10);
  EXPECT_LT(difference("0"), 10);
}

// Across a second without positions the recommended estimator says nothing, the published one
// predicts on: neither's error counts where the other has none, whichever comes first.
TEST_F(CompareEstimators, OnlyWhatAllPredictedIsCompared) {
  std::istringstream rows(read_file(record(1)));
  std::string gappy, row;
  for (int i = 0; std::getline(rows, row); ++i) {
    gappy += i > 600 && i <= 660 ? row.substr(0, row.find(',')) + ",,,,,,,,,\n" : row + "\n";
  }
  const std::string recording = folder_.write("gappy.csv", gappy), out = folder_ / "table.csv";
  const auto compare = [&](std::vector<std::string> estimators) {
    std::vector<std::string> arguments = {"compare", recording, "--faults", "event", "--out", out};
    for (const std::string& estimator : estimators) {
      arguments.insert(arguments.end(), {"--with", estimator});
    }
    EXPECT_EQ(run_condyle(arguments).exit_code, 0);
    return read_table(out);
  };
  const Table alone = compare({"published"}), other = compare({"recommended"});
  const Table table = compare({"published", "recommended"});
  const Table reversed = compare({"recommended", "published"});
  EXPECT_EQ(alone.numbers("predicted_by_all")[0], 1139);  // of 1200, without the first
  EXPECT_EQ(other.numbers("predicted_by_all")[0], 1138);  // nor the first after the gap
  EXPECT_EQ(table.numbers("predicted_by_all")[0], 1138);
  EXPECT_EQ(table.numbers("missing")[0], 60);
  EXPECT_LT(table.numbers("prediction_error_rms_mm")[0],
            0.9 * alone.numbers("prediction_error_rms_mm")[0]);
  for (const char* column : {"prediction_error_rms_mm", "log_score", "range_mm"}) {
    EXPECT_EQ(table.numbers(column)[0], reversed.numbers(column)[1]) << column;
    EXPECT_EQ(table.numbers(column)[1], reversed.numbers(column)[0]) << column;
  }
  EXPECT_NEAR(table.numbers("log_score_difference")[1],
              -reversed.numbers("log_score_difference")[1], 1e-12);
}

TEST_F(CompareEstimators, FrictionIsShownWhereTheDriveMeasuresIt) {
  const std::string recording = record(1, 0.015, 60, true);
  const std::string out = folder_ / "table.csv";
  const auto stated = run_condyle({"compare", recording, "--drive-missing", "0", "--drive-gain-sd",
                                   "0", "--drive-delay-sd-ms", "0", "--out", out});
  ASSERT_EQ(stated.exit_code, 0) << stated.errors;
  EXPECT_THAT(stated.output, HasSubstr("Ns/m, measured; mass"));
  const Table table = read_table(out);
  EXPECT_EQ(table.columns.at("friction_provenance")[0], "measured");
  EXPECT_LT(std::abs(table.numbers("friction_Ns_m")[0] - 0.022),
            4 * table.numbers("friction_sd_Ns_m")[0]);
  const auto unsaid = run_condyle({"compare", recording, "--with", "recommended", "--out", out});
  ASSERT_EQ(unsaid.exit_code, 0) << unsaid.errors;
  EXPECT_THAT(unsaid.output, AllOf(HasSubstr("assumed, no finding"), Not(HasSubstr(", measured"))));
  EXPECT_EQ(read_table(out).columns.at("friction_sd_Ns_m")[0], "");
}

// Metres or millimetres, the motion is the same.
TEST_F(CompareEstimators, UnitsMakeNoDifference) {
  const Table table = read_table(kCompared);
  std::string in_mm = "time_s,position_mm\n";
  for (std::size_t i = 0; i < table.rows; ++i) {
    in_mm +=
        fmt::format("{},{}\n", table.columns.at("time_s")[i], 1e3 * table.numbers("position_m")[i]);
  }
  const std::string out = folder_ / "table.csv";
  ASSERT_EQ(run_condyle({"compare", kCompared, folder_.write("mm.csv", in_mm), "--with",
                         "recommended", "--out", out})
                .exit_code,
            0);
  const auto range = read_table(out).numbers("range_mm");
  EXPECT_NEAR(range[0], range[1], 1e-6);
}

TEST_F(CompareEstimators, MemoryDoesNotGrowWithTheRecording) {
  if (!testing_support::command_memory_is_its_own()) {
    GTEST_SKIP() << "a sanitizer's own memory grows";
  }
  const auto peak_kB = [&](double duration_s) {
    const std::string path = folder_ / fmt::format("{}.csv", duration_s);
    const std::string command =
        fmt::format("{} {} 200 > '{}'", testing_support::program_path("make_chewing_recording"),
                    duration_s, path);
    EXPECT_EQ(std::system(command.c_str()), 0);
    const CommandResult result = run_condyle({"compare", path});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return result.peak_memory_kB;
  };
  const double long_s = testing_support::runs(1500.0, 1500.0, 3000.0);  // 200 samples a second
  EXPECT_LT(peak_kB(long_s), peak_kB(500) + 4000);
}

// A recording without any noise has a NIS of 0, which a logarithmic axis has no place for.
TEST_F(CompareEstimators, DrawsARecordingInWhichNothingMoves) {
  std::string still = "time_s,position_m\n";
  for (int i = 0; i < 1000; ++i) still += fmt::format("{:.2f},0.01\n", 0.01 * i);
  const CommandResult result = run_condyle({"compare", folder_.write("still.csv", still), "--with",
                                            "published", "--figures", folder_ / "figures"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, testing::Not(testing::HasSubstr("smoothed")));
}

}  // namespace
}  // namespace condyle
