// SPDX-License-Identifier: Apache-2.0
// The typical travel of a jaw that goes up and down by known heights.
#include "condyle/estimator/motion/cycle_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/random.h"

namespace condyle::internal {
namespace {

// Random rises and falls, each in five samples; later ones are smaller, so that only what is
// forgotten is large. A travel is known once the next one has gone the least height.
TEST(TypicalTravel, IsThe90thPercentileOfTheLast64) {
  constexpr double kLeast_m = 2e-3;
  testing_support::Random random(1);
  TypicalTravel<double> typical(kLeast_m);
  std::vector<double> travels_m;
  double height_m = 0;
  for (int i = 0; i < 300; ++i) {
    const double travel_m = kLeast_m * (1.1 + (i < 150 ? 8 : 2) * random.uniform());
    for (int k = 0; k < 5; ++k) {
      height_m += (i % 2 == 0 ? -1 : 1) * travel_m / 5;
      typical.add(height_m);
    }
    if (!travels_m.empty()) {
      const std::size_t known = std::min<std::size_t>(travels_m.size(), 64);
      const double percentile_m = typical.percentile_90_m() * (1 + 1e-9);
      const auto within =
          std::count_if(travels_m.end() - static_cast<std::ptrdiff_t>(known), travels_m.end(),
                        [=](double of_m) { return of_m <= percentile_m; });
      EXPECT_NEAR(static_cast<double>(within), 0.9 * static_cast<double>(known), 1) << i;
    }
    travels_m.push_back(travel_m);
  }
}

TEST(TypicalTravel, IsNoneWhileNothingGoesTheLeastHeight) {
  testing_support::Random random(2);
  TypicalTravel<double> typical(2e-3);
  for (int i = 0; i < 1000; ++i) typical.add(1.9e-3 * random.uniform());
  EXPECT_EQ(typical.percentile_90_m(), 0);
}

}  // namespace
}  // namespace condyle::internal
