// SPDX-License-Identifier: Apache-2.0
// What a withheld reading says would have to be recorded does narrow its interval to the limit.
#include <gmock/gmock.h>

#include <cmath>
#include <regex>
#include <string>

#include "readings/reading.h"
#include "support/random.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;
using testing_support::Random;

// `value` after the advice was followed. False if the advice gives no number.
bool follow(const std::string& advice, UncertainValue& value) {
  std::smatch found;
  if (std::regex_search(advice, found, std::regex("^(\\d+) strokes"))) {
    value.noise_sd *= std::sqrt(value.repetitions / std::stod(found[1]));
  } else if (std::regex_search(advice, found, std::regex("^([0-9.e+-]+) of the instrument"))) {
    value.noise_sd *= std::stod(found[1]);
  } else if (std::regex_search(advice, found, std::regex("located ([0-9.e+-]+) times"))) {
    for (double& change : value.fixed) change /= std::stod(found[1]);
  } else {
    return false;
  }
  return true;
}

double log_between(Random& random, double lowest, double highest) {
  return lowest * std::pow(highest / lowest, random.uniform());
}

TEST(ReadingAdvice, NarrowsTheIntervalToTheLimit) {
  Random random(1);
  int followed = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double limit = log_between(random, 0.01, 100);
    UncertainValue value;
    value.value = 1;
    value.repetitions = static_cast<int>(5 * random.uniform());
    value.noise_sd = limit * log_between(random, 0.01, 30);
    value.doubt = limit * log_between(random, 0.01, 3);
    for (int error = 0; error < 3; ++error) {
      value.fixed.push_back(limit * log_between(random, 0.01, 3));
    }
    if (value.half_interval() <= limit) continue;
    const std::string advice = what_narrows(value, limit, "strokes");
    EXPECT_THAT(advice, HasSubstr("would narrow it"));
    if (!follow(advice, value)) continue;
    ++followed;
    EXPECT_LE(value.half_interval(), limit * (1 + 1e-9)) << advice;
  }
  EXPECT_GT(followed, 4000);
}

// A hidden value may lie twice as far from the mean as the farthest known value. If more than one
// in ten is hidden, the mean has no value.
TEST(MeansOfStrokes, DoNotPassOverHiddenValues) {
  const auto mean_with = [](int known, int hidden) {
    std::vector<UncertainValue> values(static_cast<std::size_t>(known + hidden));
    for (int i = 0; i < known; ++i) values[static_cast<std::size_t>(i)].value = i % 2 == 0 ? 4 : 6;
    for (int i = known; i < known + hidden; ++i) {
      values[static_cast<std::size_t>(i)].is_hidden = true;
      values[static_cast<std::size_t>(i)].missing = "too fast";
    }
    return mean_of(values);
  };
  EXPECT_EQ(mean_with(18, 0).half_interval(), 0);
  EXPECT_NEAR(mean_with(18, 2).half_interval(), 2 * 2.0 / 20, 1e-12);
  EXPECT_EQ(mean_with(18, 2).value, 5);
  EXPECT_EQ(mean_with(9, 1).value, mean_with(9, 0).value);
  EXPECT_FALSE(mean_with(0, 3).missing.empty());
  const UncertainValue withheld = mean_with(17, 3);
  EXPECT_TRUE(std::isnan(withheld.value));
  EXPECT_THAT(withheld.missing, HasSubstr("not known for 3 of 20"));
  EXPECT_THAT(withheld.missing, HasSubstr("too fast"));
}

// What corrections leave of a mean: a shared error stays, one that differs from stroke to stroke
// becomes smaller like noise, and none vanishes because signs happen to cancel.
TEST(MeansOfStrokes, KeepWhatCorrectionsMayLeave) {
  Random random(2);
  for (const double shared : {0.0, 1.0}) {
    for (const int strokes : {1, 3, 16, 100}) {
      std::vector<UncertainValue> values(static_cast<std::size_t>(strokes));
      double sum = 0, squares = 0;
      for (UncertainValue& value : values) {
        value.value = 5;
        value.doubt = 0.25;
        const double left = shared + 0.5 * random.normal();
        value.corrections = {left, -left};
        sum += left / strokes;
        squares += left * left / strokes;
      }
      const UncertainValue mean = mean_of(values);
      const double expected = std::max(std::abs(sum), std::sqrt(squares / strokes));
      EXPECT_EQ(mean.doubt, 0.25);
      for (const double correction : mean.corrections) {
        EXPECT_NEAR(std::abs(correction), expected, 1e-12);
      }
      EXPECT_NEAR(mean.half_interval(), std::hypot(0.25, expected, expected), 1e-12);
    }
  }
}

TEST(ReadingAdvice, NamesWhatIsNeeded) {
  UncertainValue value;
  value.noise_sd = 1;
  EXPECT_EQ(what_narrows(value, 0.98, "strokes"),
            "0.5 of the instrument's noise would narrow it to the limit");
  value.repetitions = 3;
  EXPECT_EQ(what_narrows(value, 0.98, "cycles"),
            "12 cycles like these would narrow it to the limit");
  EXPECT_THAT(what_narrows(value, 0.1, "cycles"), HasSubstr("0.051 of the instrument's noise"));
  value.noise_sd = 0;
  value.fixed = {1};
  EXPECT_THAT(what_narrows(value, 0.98, "strokes"), HasSubstr("located 2.0 times as exactly"));
  value.doubt = 1;
  EXPECT_EQ(what_narrows(value, 0.9, "strokes"),
            "more exactly located landmarks and a higher sampling rate would "
            "narrow it");
  value.fixed.clear();
  EXPECT_EQ(what_narrows(value, 0.9, "strokes"),
            "a higher sampling rate or less noise would narrow it");
}

}  // namespace
}  // namespace condyle::host
