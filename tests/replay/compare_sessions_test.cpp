// SPDX-License-Identifier: Apache-2.0
// compare: sessions of one simulated subject, and what it cannot use.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "replay/compare_fixture.h"
#include "support/command.h"
#include "support/paths.h"
#include "support/table.h"

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

const std::string kOneAxis = testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");

class CompareSessions : public testing_support::CompareTest {};

// The third session opens a fifth further.
TEST_F(CompareSessions, SessionsOfASubjectThatChanged) {
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
                    HasSubstr("it is not a diagnosis"), HasSubstr("mounted anew")));
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

TEST_F(CompareSessions, WithoutRepeatsTheSmallestChangeIsNotKnown) {
  const std::string out = folder_ / "table.csv";
  const CommandResult result =
      run_condyle({"compare", "--session", session("a", {record(1)}), "--session",
                   session("b", {record(2, 0.03)}), "--out", out});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("NOT KNOWN, no session has repeats"),
                                   HasSubstr("whether it exceeds chance is not known"),
                                   Not(HasSubstr("CHANGED"))));
  for (const char* column : {"smallest_change", "smallest_change_single", "exceeds"}) {
    EXPECT_EQ(read_table(out).columns.at(column)[0], "") << column;
  }
}

// What is known of the recordings is said beside what came out of them.
TEST_F(CompareSessions, SessionsThatDifferInMoreThanTheSubjectAreNoted) {
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
  EXPECT_THAT(result.output, AllOf(HasSubstr("not compared: the recordings last 11.6 to 20 s"),
                                   HasSubstr("gappy.csv: 89 % of its samples measure the motion")));
}

// The published cascade's friction never gets into a comparison.
TEST_F(CompareSessions, AssumedValuesAreNotCompared) {
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

TEST_F(CompareSessions, SaysWhatItCannotUse) {
  const std::string a = record(1), b = record(2), fast = record(3, 0.015, 120);
  const std::string copy = folder_.write("copy.csv", read_file(a));
  refuse({}, "has nothing to compare");
  refuse({"--session", session("a", {a, b})}, "one session cannot be compared");
  refuse({"--session", "a=", "--session", session("b", {b})}, "a: has no recordings");
  refuse({"--session", "a=" + a + ",,", "--session", session("b", {b})}, "names is empty");
  refuse({"--session", a, "--session", session("b", {b})}, "lacks a name");
  refuse({"--session", session("a", {a}), "--session", session("a", {b})}, "is given twice");
  refuse({"--session", session("a", {a, b}), "--session", session("b", {b})}, "is given twice");
  refuse({"--session", session("a", {a, b}), "--session", session("b", {copy})}, "is a copy of");
  refuse({"--session", session("a", {a, b}), "--session", session("b", {fast})},
         "compare recordings of one rate");
  refuse({"--session", session("a", {a, b}), "--session", session("b", {kOneAxis})},
         "compare recordings of one kind");
  refuse({a, "--session", session("a", {a}), "--session", session("b", {b})}, "outside a session");
  refuse({"--session", session("a", {a}), "--session", session("b", {b}), "--with", "recommended",
          "--with", "published"},
         "compared with one estimator");
  refuse({a, a}, "is given twice");
  refuse({a, folder_ / "missing.csv"}, "missing.csv");
  refuse({a, "--with", "kalman"}, "kalman: is not an estimator");
  refuse({a, "--with", "recommended:" + folder_ / "none.toml"}, "none.toml");
  refuse({a, "--with", "published", "--with", "published"}, "is given twice");
  refuse({a, "--with", "published", "--lag", "3"}, "--lag");
  refuse({a, "--out", a}, "is also an input");
  refuse({a, "--drive-missing", "0"}, "has no drive");
  refuse({a, "--with", "published", "--drive-missing", "0"}, "--drive-...");
  refuse({kOneAxis, "--axis", "x"}, "has one axis");
  refuse({kOneAxis, "--point", "2"}, "not point 2");
  EXPECT_EQ(run_condyle({"compare", a, "--lag", "17"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "table.csv"));
}

}  // namespace
}  // namespace condyle
