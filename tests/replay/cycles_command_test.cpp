// SPDX-License-Identifier: Apache-2.0
// Chewing cycles as they end, as a user of replay meets them.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "replay/hinged_jaw.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing_support::CommandResult;
using testing_support::HingedJaw;
using testing_support::read_table;
using testing_support::run_condyle;
using testing_support::Table;

// Closed at each full second, most open half a second later.
class CyclesCommand : public HingedJaw {
 protected:
  Table cycles(const std::string& recording, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--axis", "z", "--cycles", folder_ / "cycles.csv"});
    replay(recording, std::move(more));
    return read_table(folder_ / "cycles.csv");
  }
  std::string problem(std::vector<std::string> more) {
    more.insert(more.begin(), {"replay", write([](int, double*) {})});
    const CommandResult result = run_condyle(more);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    return result.errors;
  }
};

TEST_F(CyclesCommand, AreThoseOfTheJaw) {
  const Table table = cycles(write([](int, double*) {}));
  ASSERT_GE(table.rows, 9U);
  const auto column = [&table](const std::string& name) { return table.numbers(name); };
  // Point 1, 80 mm before the hinge and 40 mm below it, at 0.3 rad.
  const double height_m = 0.080 * std::sin(0.3) - 0.040 * (1 - std::cos(0.3));
  for (std::size_t i = 0; i < table.rows; ++i) {
    EXPECT_NEAR(column("begin_s")[i], std::round(column("begin_s")[i]), 0.03) << i;
    EXPECT_NEAR(column("turn_s")[i], std::round(column("begin_s")[i]) + 0.5, 0.03) << i;
    EXPECT_NEAR(column("duration_s")[i], 1, 4 * column("duration_sd_s")[i]) << i;
    EXPECT_NEAR(column("height_m")[i], height_m, 5e-4) << i;
    EXPECT_GE(column("known_s")[i], column("end_s")[i]) << i;
    EXPECT_EQ(column("cycle")[i], static_cast<double>(i + 1));
    EXPECT_EQ(column("sequence")[i], 1);
    EXPECT_EQ(table.columns.at("rejected")[i], "");
    EXPECT_EQ(table.columns.at("duration_provenance")[i], "measured");
  }
  EXPECT_THAT(summary_, HasSubstr(" taken, 0 not taken; mean duration 1 s"));
}

TEST_F(CyclesCommand, GoFromOpenToOpenWhereTheJawClosesTheOtherWay) {
  const Table table = cycles(write([](int, double*) {}), {"--closing", "negative"});
  ASSERT_GE(table.rows, 8U);
  for (const double begin_s : table.numbers("begin_s")) {
    EXPECT_NEAR(begin_s, std::round(begin_s + 0.5) - 0.5, 0.03);
  }
}

TEST_F(CyclesCommand, WithAGapAreListedWithTheReason) {
  const Table table = cycles(write([](int i, double* points) {
                               if (i >= 196 && i < 206) {
                                 points[0] = std::numeric_limits<double>::quiet_NaN();
                               }
                             }),
                             {"--faults", "event"});
  ASSERT_GE(table.rows, 9U);
  for (std::size_t i = 0; i < table.rows; ++i) {
    const bool is_hurt = std::abs(table.numbers("turn_s")[i] - 3.5) < 0.2;
    EXPECT_EQ(table.columns.at("rejected")[i].empty(), !is_hurt) << i;
    EXPECT_EQ(table.columns.at("cycle")[i].empty(), is_hurt) << i;
    EXPECT_EQ(table.columns.at("height_m")[i].empty(), is_hurt) << i;
    if (is_hurt) {
      EXPECT_THAT(table.columns.at("rejected")[i], HasSubstr("a gap of 0.18 s"));
    }
  }
  EXPECT_THAT(summary_, HasSubstr(" 1 not taken"));
}

TEST_F(CyclesCommand, RefusesWhatCannotBe) {
  EXPECT_THAT(problem({"--closing", "negative"}), HasSubstr("--cycles"));
  EXPECT_THAT(problem({"--cycles", folder_ / "c.csv", "--estimator", "published"}),
              HasSubstr("--cycles"));
  EXPECT_THAT(problem({"--cycles", folder_ / "c.csv", "--out", folder_ / "c.csv"}),
              HasSubstr("c.csv"));
}

}  // namespace
}  // namespace condyle
