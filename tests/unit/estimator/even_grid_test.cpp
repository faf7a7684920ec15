// SPDX-License-Identifier: Apache-2.0
// Samples at any times become even ones.
#include "condyle/estimator/impedance/even_grid.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <vector>

namespace condyle {
namespace {

constexpr TimeNs kStep_ns = 16'666'667;

struct Point {
  TimeNs time_ns;
  double value;
};

template <class Value>
std::vector<Point> gridded(const std::vector<TimeNs>& times, const Value& value) {
  EvenGrid<double> grid(kStep_ns);
  std::vector<Point> points;
  for (const TimeNs time_ns : times) {
    grid.add(time_ns, value(seconds(time_ns)), [&](TimeNs at_ns, double at) {
      points.push_back({at_ns, at});
    });
  }
  return points;
}

TEST(EvenGrid, PassesEvenSamplesAsTheyAre) {
  std::vector<TimeNs> times;
  for (TimeNs k = 0; k < 100; ++k) times.push_back(1000 + k * kStep_ns + (k % 3) * 1000);
  int next = 0;
  const auto points = gridded(times, [&](double) { return std::sqrt(++next); });
  ASSERT_EQ(points.size(), times.size());
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_EQ(points[k].time_ns, times[k]);
    EXPECT_EQ(points[k].value, std::sqrt(static_cast<double>(k + 1)));
  }
}

TEST(EvenGrid, InterpolatesWhatIsDueBetweenSamples) {
  EXPECT_TRUE(rc::check("jittered and dropped", [] {
    std::vector<TimeNs> times;
    for (TimeNs k = 0; k < 60; ++k) {
      if (k > 3 && *rc::gen::inRange(0, 8) == 0 && times.back() > (k - 2) * kStep_ns) continue;
      times.push_back(k * kStep_ns + *rc::gen::inRange(0, 5'000'000));
    }
    const auto motion = [](double t) { return 0.0075 * std::sin(8 * t + 1); };
    const auto points = gridded(times, motion);
    RC_ASSERT(points.size() + 12 >= 60U);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const TimeNs step_ns = points[k].time_ns - points[k - 1].time_ns;
      RC_ASSERT(std::abs(step_ns - kStep_ns) <= kStep_ns / 50);
      RC_ASSERT(std::abs(points[k].value - motion(seconds(points[k].time_ns))) < 2e-5);
    }
  }));
}

TEST(EvenGrid, LeavesOutASampleThatFollowsTooSoon) {
  std::vector<TimeNs> times;
  for (TimeNs k = 0; k < 20; ++k) {
    times.push_back(k * kStep_ns);
    times.push_back(k * kStep_ns + 1'000'000);
  }
  EXPECT_EQ(gridded(times, [](double t) { return t; }).size(), 20U);
}

}  // namespace
}  // namespace condyle
