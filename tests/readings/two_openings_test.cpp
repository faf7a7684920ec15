// SPDX-License-Identifier: Apache-2.0
// Cycles in which the jaw opens twice, nearly equally far. Which opening is the deeper one decides
// when the jaw turns: noise must not choose it with confidence.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "readings/simulated_readings.h"

namespace condyle::host {
namespace {

constexpr int kCycles = 20;
constexpr double kRest_s = 3, kPeriod_s = 1.3, kDepth_m = 0.015;

// A cycle with openings at 0.3 and 0.7 of its time; the second one is deeper by `deeper_m`.
struct TwoOpenings {
  double deeper_m, rise_m;

  double depth_at_m(double share) const {
    const double envelope = std::pow(std::sin(std::numbers::pi * std::clamp(share, 0.0, 1.0)), 0.5);
    const double bump = std::exp(-std::pow((share - 0.5) / 0.1, 2));
    return envelope * (kDepth_m + deeper_m * (share - 0.5) / 0.4) - rise_m * bump;
  }
  // Flat where the teeth meet.
  double height_at_m(double time_s) const {
    const double since_s = time_s - kRest_s;
    if (since_s < 0 || since_s >= kCycles * kPeriod_s) return 0;
    const double share = std::fmod(since_s, kPeriod_s) / kPeriod_s;
    const double rising = std::clamp(std::min(share, 1 - share) / 0.2, 0.0, 1.0);
    const double smooth = rising * rising * rising * (10 + rising * (-15 + 6 * rising));
    return -smooth * depth_at_m(share);
  }
  double opening_s() const {
    double deepest_s = 0, lowest_m = 0;
    for (double time_s = 0; time_s < kPeriod_s; time_s += 1e-4) {
      const double height_m = height_at_m(kRest_s + time_s);
      if (height_m > lowest_m) continue;
      lowest_m = height_m;
      deepest_s = time_s;
    }
    return deepest_s;
  }
};

TEST(TwoOpenings, HaveATurnThatNoiseDoesNotChoose) {
  int shown = 0, held = 0, hidden = 0, of_speeds = 0;
  for (const double deeper_m : {-3e-4, -3e-5, 3e-5, 3e-4}) {
    for (const double noise_m : {2e-5, 1e-4}) {
      const TwoOpenings two{deeper_m, 0.004};
      const Analysis analysis =
          analysis_of_heights([&](double time_s) { return two.height_at_m(time_s); }, kRest_s,
                              kCycles * kPeriod_s, 100, noise_m);
      const auto names = readings_of_cycle(true);
      const auto at = [&](const char* name) {
        return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) -
                                        names.begin());
      };
      for (const AnalysedCycle& cycle : analysis.cycles) {
        // The first and the last one begin and end with the rest.
        if (cycle.number < 2 || cycle.number >= kCycles) continue;
        const UncertainValue& opening_s = cycle.values[at("opening_time_s")];
        ++shown;
        held += std::abs(opening_s.value - two.opening_s()) <= opening_s.half_interval();
        const bool knows_turn = opening_s.half_interval() <= 0.2;
        const UncertainValue& speed = cycle.values[at("closing_peak_speed_mm_s")];
        ++of_speeds;
        hidden += !knows_turn;
        if (!knows_turn) {
          EXPECT_TRUE(speed.is_hidden);
          EXPECT_EQ(speed.missing, "when the jaw turns is not known to 0.2 s");
        }
      }
      for (const JawReading& reading : analysis.readings) {
        const std::string name(reading.definition->name);
        const bool is_mean = name == "opening_time_s";
        if (!is_mean || reading.provenance == ReadingProvenance::withheld) continue;
        EXPECT_LE(reading.low, two.opening_s()) << deeper_m << " " << noise_m;
        EXPECT_GE(reading.high, two.opening_s()) << deeper_m << " " << noise_m;
      }
    }
  }
  std::printf("%d of %d opening times held; turn not known in %d\n", held, shown, hidden);
  EXPECT_EQ(shown, 8 * (kCycles - 2));
  // Measured: 129 of 144. The cycles of a noise share their draws between depths.
  EXPECT_GE(held, 0.85 * shown);
  EXPECT_GT(hidden, 0);
  EXPECT_LT(hidden, of_speeds);
}

}  // namespace
}  // namespace condyle::host
