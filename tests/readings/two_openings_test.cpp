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
constexpr double kRest_s = 3, kPeriod_s = 1.3, kDepth_m = 0.012;

// A cycle with openings at 0.3 and 0.7 of its time; the second one is deeper by `deeper_m`. Between
// them the jaw rises by 3 mm, within about `rise_share` of the time.
struct TwoOpenings {
  double deeper_m, rise_share;

  double height_at_m(double time_s) const {
    constexpr double kRise_m = 0.003;
    const double since_s = time_s - kRest_s;
    if (since_s < 0 || since_s >= kCycles * kPeriod_s) return 0;
    const double share = std::fmod(since_s, kPeriod_s) / kPeriod_s;
    const double depth_m = kDepth_m + deeper_m * (share - 0.5) / 0.4 -
                           kRise_m * std::exp(-std::pow((share - 0.5) / rise_share, 2));
    const double way = std::clamp(std::min(share, 1 - share) / 0.2, 0.0, 1.0);
    return -way * way * way * (10 + way * (-15 + 6 * way)) * depth_m;
  }

  std::map<std::string, double> truth() const {
    constexpr double kStep_s = 1e-4;
    double turn_s = 0;
    for (double time_s = 0; time_s < kPeriod_s; time_s += kStep_s) {
      if (height_at_m(kRest_s + time_s) < height_at_m(kRest_s + turn_s)) turn_s = time_s;
    }
    double opening_m_s = 0, closing_m_s = 0;
    for (double time_s = kStep_s; time_s < kPeriod_s - kStep_s; time_s += kStep_s) {
      double& peak_m_s = time_s < turn_s ? opening_m_s : closing_m_s;
      const double at_s = kRest_s + time_s;
      const double change_m = height_at_m(at_s + kStep_s) - height_at_m(at_s - kStep_s);
      peak_m_s = std::max(peak_m_s, std::abs(change_m) / (2 * kStep_s));
    }
    return {{"opening_time_s", turn_s},
            {"closing_time_s", kPeriod_s - turn_s},
            {"opening_peak_speed_mm_s", 1e3 * opening_m_s},
            {"closing_peak_speed_mm_s", 1e3 * closing_m_s}};
  }
};

struct Held {
  int all = 0, shown = 0, held = 0, hidden = 0;
};

TEST(TwoOpenings, HaveATurnThatNoiseDoesNotChoose) {
  std::map<std::string, Held> cycles, means;
  for (const double rise_share : {0.02, 0.1}) {
    for (const double deeper_m : {-3e-4, -3e-5, 3e-5, 3e-4}) {
      for (const double noise_m : {2e-5, 1e-4}) {
        const TwoOpenings two{deeper_m, rise_share};
        const Analysis analysis =
            analysis_of_heights([&](double time_s) { return two.height_at_m(time_s); }, kRest_s,
                                kCycles * kPeriod_s, 100, noise_m);
        const auto names = readings_of_cycle(true);
        for (const auto& [name, truth] : two.truth()) {
          const auto at =
              static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
          for (const AnalysedCycle& cycle : analysis.cycles) {
            // The first and the last one begin and end with the rest.
            if (cycle.number < 2 || cycle.number >= kCycles) continue;
            const UncertainValue& value = cycle.values[at];
            Held& held = cycles[name];
            ++held.all;
            held.hidden += value.is_hidden;
            if (!std::isfinite(value.value)) continue;
            ++held.shown;
            held.held += std::abs(value.value - truth) <= value.half_interval();
          }
          for (const JawReading& reading : analysis.readings) {
            if (reading.task != TaskKind::chewing || reading.definition->name != name) continue;
            Held& held = means[name];
            ++held.all;
            if (reading.provenance == ReadingProvenance::withheld) continue;
            ++held.shown;
            held.held += reading.low <= truth && truth <= reading.high;
          }
        }
      }
    }
  }
  for (const auto& [name, held] : cycles) {
    std::printf("%-26s %d of %d shown, %d held, %d hidden; means: %d of %d shown, %d held\n",
                name.c_str(), held.shown, held.all, held.held, held.hidden, means[name].shown,
                means[name].all, means[name].held);
    EXPECT_EQ(held.all, 16 * (kCycles - 2)) << name;
    EXPECT_GT(held.shown, held.all / 2) << name;
    EXPECT_GT(means[name].shown, 0) << name;
    // The cycles of a noise share their draws between depths.
    EXPECT_GE(held.held, 0.85 * held.shown) << name;
    // Measured: 7 of 10 for the times. The bottom is nearly flat, so that smoothing moves the turn.
    EXPECT_GE(means[name].held, 0.6 * means[name].shown) << name;
  }
  // Where the rise between them is the fastest movement, a speed depends on the turn.
  EXPECT_GT(cycles["closing_peak_speed_mm_s"].hidden, 0);
  EXPECT_GT(cycles["closing_peak_speed_mm_s"].shown, 0);
}

}  // namespace
}  // namespace condyle::host
