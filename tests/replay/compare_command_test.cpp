// SPDX-License-Identifier: Apache-2.0
// compare: estimators on the same recordings, and sessions of one simulated subject.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "replay/command.h"
#include "replay/table.h"
#include "unit/temporary_folder.h"

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
using testing_support::TemporaryFolder;

constexpr const char* kChewing = CONDYLE_SOURCE_DIR "/host_sim/recordings/chewing_60hz.csv";

class Compare : public testing::Test {
 protected:
  // A point mass that chews for 20 s; the drive as a column where asked for.
  std::string record(int seed, double amplitude_m = 0.015, double rate_Hz = 60,
                     bool with_drive = false) {
    const std::string name = fmt::format("r{}_{}_{}", seed, amplitude_m, rate_Hz);
    const std::string scenario = folder_.write(
        name + ".toml",
        fmt::format("duration_s = 20\n[subject]\nmotion = \"point_mass\"\ndrive = \"force\"\n"
                    "mass_kg = 0.25\nsupport_stiffness_N_m = 20\nsupport_rest_m = -0.010\n"
                    "[task]\nrest_position_m = 0.0\namplitude_m = {}\namplitude_spread = 0.05\n"
                    "cycle_rate_Hz = 1.3\nrate_spread = 0.08\n[friction]\nviscous_Ns_m = 0.022\n"
                    "[facebow]\nrate_Hz = {}\n[drive]\nrate_Hz = 60\nnoise_N = 0.01\n",
                    amplitude_m, rate_Hz));
    const std::string path = folder_ / (name + ".csv");
    const auto result =
        run_condyle({"simulate", scenario, "--seed", std::to_string(seed), "--out", path});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return with_drive ? join_drive(name) : path;
  }

  // Both have the same times.
  std::string join_drive(const std::string& name) {
    std::istringstream positions(read_file(folder_ / (name + ".csv")));
    std::istringstream drives(read_file(folder_ / (name + ".drive.csv")));
    std::string joined, position, drive;
    while (std::getline(positions, position) && std::getline(drives, drive)) {
      const std::size_t comma = drive.find(',');
      EXPECT_EQ(drive.substr(0, comma), position.substr(0, position.find(',')));
      joined += position + drive.substr(comma) + "\n";
    }
    return folder_.write(name + ".joined.csv", joined);
  }

  static std::string session(const std::string& name, const std::vector<std::string>& files) {
    return fmt::format("{}={}", name, fmt::join(files, ","));
  }

  static void refuse(const std::vector<std::string>& arguments, const std::string& words) {
    std::vector<std::string> all = {"compare"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandResult result = run_condyle(all);
    EXPECT_EQ(result.exit_code, 2) << words;
    EXPECT_THAT(result.errors, HasSubstr(words));
    EXPECT_EQ(result.output, "");
  }

  TemporaryFolder folder_;
};

TEST_F(Compare, EstimatorsOnTheShippedRecording) {
  const std::string out = folder_ / "table.csv";
  const CommandResult result =
      run_condyle({"compare", kChewing, "--out", out, "--figures", folder_ / "figures"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("research use only"), HasSubstr("recommended"),
                    HasSubstr("Ns/m, assumed, no finding"), HasSubstr("one in 20 does by chance"),
                    HasSubstr("no difference of them does"), Not(HasSubstr(", measured"))));
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
TEST_F(Compare, AgreesWithReplay) {
  for (const char* estimator : {"recommended", "published"}) {
    const std::string out = folder_ / "table.csv", rows = folder_ / "rows.csv";
    ASSERT_EQ(run_condyle({"compare", kChewing, "--with", estimator, "--out", out}).exit_code, 0);
    ASSERT_EQ(run_condyle({"replay", kChewing, "--estimator", estimator, "--out", rows}).exit_code,
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
TEST_F(Compare, TheSameEstimatorDiffersByNothing) {
  const std::string heavy = folder_.write("heavy.toml", "assumed_mass_kg = 0.5\n");
  const std::string out = folder_ / "table.csv";
  for (const char* lag : {"0", "5"}) {
    const CommandResult result =
        run_condyle({"compare", kChewing, record(1), "--with", "recommended", "--with",
                     "recommended:" + heavy, "--with", "published", "--lag", lag, "--out", out});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_THAT(result.output, HasSubstr("no difference to tell"));
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
TEST_F(Compare, RowsOfOneInstantAreCompared) {
  const std::string out = folder_ / "table.csv";
  const auto difference = [&](const char* lag) {
    EXPECT_EQ(run_condyle({"compare", kChewing, "--lag", lag, "--out", out}).exit_code, 0);
    EXPECT_EQ(read_table(out).numbers("predicted_by_all")[0], 1799);
    return read_table(out).numbers("velocity_difference_rms_mm_s")[1];
  };
  // Five samples apart, the velocities would differ by some 30 mm/s.
  EXPECT_LT(difference("5"), 10);
  EXPECT_LT(difference("0"), 10);
}

// Across a second without positions the recommended estimator says nothing, the published one
// predicts on: neither's error counts where the other has none, whichever comes first.
TEST_F(Compare, OnlyWhatAllPredictedIsCompared) {
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

TEST_F(Compare, FrictionIsShownWhereTheDriveMeasuresIt) {
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

// The third session opens a fifth further.
TEST_F(Compare, SessionsOfASubjectThatChanged) {
  const std::string out = folder_ / "table.csv";
  const CommandResult result =
      run_condyle({"compare", "--session", session("before", {record(1), record(2), record(3)}),
                   "--session", session("after", {record(4), record(5), record(6)}), "--session",
                   session("later", {record(7, 0.018), record(8, 0.018), record(9, 0.018)}),
                   "--out", out, "--figures", folder_ / "figures"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("before to later: +"), HasSubstr("CHANGED, also among so many"),
                    HasSubstr("of 18 comparisons exceed"), HasSubstr("(0.9 of these)"),
                    HasSubstr("it diagnoses nothing"), HasSubstr("mounted anew")));
  const Table table = read_table(out);
  ASSERT_EQ(table.rows, 18U);  // six quantities, three pairs
  for (std::size_t i = 0; i < table.rows; ++i) {
    EXPECT_EQ(table.numbers("degrees_of_freedom")[i], 6);
    const double change = table.numbers("change")[i];
    EXPECT_NEAR(change, table.numbers("mean_to")[i] - table.numbers("mean_from")[i], 1e-12);
    EXPECT_NEAR(table.numbers("smallest_change")[i],
                2.446912 * std::sqrt(2.0 / 3) * table.numbers("within_session_sd")[i],
                1e-6 * table.numbers("smallest_change")[i]);
    EXPECT_EQ(table.numbers("exceeds")[i] == 1,
              std::abs(change) > table.numbers("smallest_change")[i]);
    if (table.columns.at("quantity")[i] != "velocity_rms") continue;
    const bool is_changed = table.columns.at("to")[i] == "later";
    EXPECT_EQ(table.numbers("exceeds_adjusted")[i] == 1, is_changed);
  }
  EXPECT_THAT(read_file(folder_ / "figures/sessions.svg"),
              AllOf(HasSubstr("research use only"), HasSubstr("range of motion")));
}

TEST_F(Compare, WithoutRepeatsTheSmallestChangeIsNotKnown) {
  const std::string out = folder_ / "table.csv";
  const CommandResult result =
      run_condyle({"compare", "--session", session("a", {record(1)}), "--session",
                   session("b", {record(2, 0.03)}), "--out", out});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("NOT KNOWN, no session has repeats"),
                                   HasSubstr("whether it is more than chance is not known"),
                                   Not(HasSubstr("CHANGED"))));
  for (const char* column : {"smallest_change", "smallest_change_single", "exceeds"}) {
    EXPECT_EQ(read_table(out).columns.at(column)[0], "") << column;
  }
}

// What is known of the recordings is said beside what came out of them.
TEST_F(Compare, SessionsThatDifferInMoreThanTheSubjectAreNoted) {
  std::istringstream rows(read_file(record(4)));
  std::string shorter, gappy, row;
  for (int i = 0; std::getline(rows, row); ++i) {
    if (i < 700) shorter += row + "\n";
    // Ten samples in a hundred are missing.
    gappy += i > 0 && i % 100 < 10 ? row.substr(0, row.find(',')) + ",,,,,,,,,\n" : row + "\n";
  }
  const std::string short_one = folder_.write("short.csv", shorter);
  const std::string gappy_one = folder_.write("gappy.csv", gappy);
  const CommandResult result = run_condyle({"compare", "--faults", "event", "--session",
                                            session("a", {record(1), record(2)}), "--session",
                                            session("b", {short_one, gappy_one})});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("the recordings last 11.6 to 20 s"),
                                   HasSubstr("gappy.csv: 89 % of its samples measure the motion")));
}

// The published cascade's friction never gets into a comparison.
TEST_F(Compare, AssumedValuesAreNotCompared) {
  const std::string out = folder_ / "table.csv";
  const CommandResult result = run_condyle({"compare", "--with", "published", "--session",
                                            session("a", {record(1), record(2)}), "--session",
                                            session("b", {record(3), record(4)}), "--out", out});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("in 4 of 4 recordings it is not measured"));
  const Table table = read_table(out);
  EXPECT_EQ(table.rows, 4U);
  EXPECT_THAT(table.columns.at("quantity"),
              testing::Not(testing::Contains(testing::AnyOf("friction", "mass", "noise_sd"))));
}

TEST_F(Compare, SaysWhatItCannotUse) {
  const std::string a = record(1), b = record(2), fast = record(3, 0.015, 120);
  const std::string copy = folder_.write("copy.csv", read_file(a));
  refuse({}, "has nothing to compare");
  refuse({"--session", session("a", {a, b})}, "one session alone");
  refuse({"--session", "a=", "--session", session("b", {b})}, "a: has no recordings");
  refuse({"--session", "a=" + a + ",,", "--session", session("b", {b})}, "names is empty");
  refuse({"--session", a, "--session", session("b", {b})}, "does not say its name");
  refuse({"--session", session("a", {a}), "--session", session("a", {b})}, "is given twice");
  refuse({"--session", session("a", {a, b}), "--session", session("b", {b})}, "is named twice");
  refuse({"--session", session("a", {a, b}), "--session", session("b", {copy})}, "is a copy of");
  refuse({"--session", session("a", {a, b}), "--session", session("b", {fast})},
         "compare recordings of one rate");
  refuse({"--session", session("a", {a, b}), "--session", session("b", {kChewing})},
         "compare recordings of one kind");
  refuse({a, "--session", session("a", {a}), "--session", session("b", {b})}, "named apart");
  refuse({"--session", session("a", {a}), "--session", session("b", {b}), "--with", "recommended",
          "--with", "published"},
         "compared by one estimator");
  refuse({a, a}, "is named twice");
  refuse({a, folder_ / "missing.csv"}, "missing.csv");
  refuse({a, "--with", "kalman"}, "kalman: is no estimator");
  refuse({a, "--with", "recommended:" + folder_ / "none.toml"}, "none.toml");
  refuse({a, "--with", "published", "--with", "published"}, "is given twice");
  refuse({a, "--with", "published", "--lag", "3"}, "--lag");
  refuse({a, "--out", a}, "is also an input");
  refuse({a, "--drive-missing", "0"}, "has no drive");
  refuse({a, "--with", "published", "--drive-missing", "0"}, "--drive-...");
  refuse({kChewing, "--axis", "x"}, "has one axis");
  refuse({kChewing, "--point", "2"}, "not point 2");
  EXPECT_EQ(run_condyle({"compare", a, "--lag", "17"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "table.csv"));
}

// Metres or millimetres, the motion is the same.
TEST_F(Compare, UnitsMakeNoDifference) {
  const Table table = read_table(kChewing);
  std::string in_mm = "time_s,position_mm\n";
  for (std::size_t i = 0; i < table.rows; ++i) {
    in_mm +=
        fmt::format("{},{}\n", table.columns.at("time_s")[i], 1e3 * table.numbers("position_m")[i]);
  }
  const std::string out = folder_ / "table.csv";
  ASSERT_EQ(run_condyle({"compare", kChewing, folder_.write("mm.csv", in_mm), "--with",
                         "recommended", "--out", out})
                .exit_code,
            0);
  const auto range = read_table(out).numbers("range_mm");
  EXPECT_NEAR(range[0], range[1], 1e-6);
}

TEST_F(Compare, MemoryDoesNotGrowWithTheRecording) {
  const auto peak_kB = [&](double duration_s) {
    const std::string path = folder_ / fmt::format("{}.csv", duration_s);
    const std::string command =
        fmt::format(CONDYLE_MAKE_CHEWING " {} 200 > '{}'", duration_s, path);
    EXPECT_EQ(std::system(command.c_str()), 0);
    const CommandResult result = run_condyle({"compare", path});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return result.peak_memory_kB;
  };
  EXPECT_LT(peak_kB(3000), peak_kB(500) + 4000);  // 600,000 samples and 100,000
}

}  // namespace
}  // namespace condyle
