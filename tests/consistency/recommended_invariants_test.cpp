// SPDX-License-Identifier: Apache-2.0
// What must hold whatever is recorded: glitches in bursts of any shape, abrupt starts and stops,
// any rate, noise, rounding, dropouts and frozen stretches, in any order.
//
// Everything is drawn from fixed seeds, over wider ranges than any recording at hand.
#include "consistency/any_recording.h"
#include "support/tier.h"

namespace condyle::testing_support {
namespace {

// In any order: rest, chewing, jumps to a stop, bursts, dropouts, frozen stretches.
Recording anything(Random& random, double rate_Hz) {
  Recording recording;
  const double noise_m = log_between(random, 3e-6, 300e-6);
  const double grid_m = random.uniform() < 0.3 ? log_between(random, 1e-5, 3e-4) : 0;
  double t = 0, offset_m = 0;
  const auto measured = [&](double truth) {
    const double z = truth + noise_m * random.normal();
    return grid_m > 0 ? grid_m * std::round(z / grid_m) : z;
  };
  for (int part = 0; part < 12; ++part) {
    const auto course = any_chewing(random);
    const std::size_t kind = index_below(random, 6);
    const double duration_s = kind < 2 ? 1 + random.uniform() : 0.02 + 0.4 * random.uniform();
    const auto count = static_cast<std::size_t>(duration_s * rate_Hz) + 1;
    const int shape = static_cast<int>(index_below(random, 5));
    const double size_m = log_between(random, 20 * noise_m, 0.2);
    const double start_m = course(0);
    for (std::size_t i = 0; i < count; ++i, t += 1 / rate_Hz) {
      const double moved = kind == 0 ? 0 : course(static_cast<double>(i) / rate_Hz) - start_m;
      const double truth = offset_m + moved;
      const bool is_glitch = kind == 3 && i < 8;
      const double z = measured(truth) + (is_glitch ? burst_m(shape, size_m, i, random) : 0);
      const bool is_frozen = kind == 5 && !recording.samples.empty();
      recording.add(t, truth, is_frozen ? recording.samples.back().coordinates[0] : z, kind != 4);
    }
    offset_m = recording.truth_m.back();
  }
  return recording;
}

class Invariants : public AtAnyRate {};
INSTANTIATE_TEST_SUITE_P(Rates, Invariants, testing::ValuesIn(kRates_Hz));

TEST_P(Invariants, NoDeviationFallsWhereNothingIsTaken) {
  std::size_t untaken = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const Estimates estimates = run(anything(random, rate_Hz()), rate_Hz());
    for (std::size_t i = 1; i < estimates.size(); ++i) {
      const EventSet events = estimates[i].events;
      const bool is_untaken =
          events.has(Event::outlier_rejected) || events.has(Event::position_missing) ||
          events.has(Event::position_repeated) || events.has(Event::position_frozen);
      if (!is_untaken || events.has(Event::state_restarted)) continue;
      if (!is_shown(estimates[i]) || !is_shown(estimates[i - 1])) continue;
      ++untaken;
      const auto &now = estimates[i].axes[0], &before = estimates[i - 1].axes[0];
      ASSERT_GE(now.position_m.standard_deviation, before.position_m.standard_deviation)
          << "seed " << seed << " sample " << i;
      ASSERT_GE(now.velocity_m_s.standard_deviation, before.velocity_m_s.standard_deviation);
      ASSERT_GE(now.acceleration_m_s2.standard_deviation,
                before.acceleration_m_s2.standard_deviation);
    }
  }
  EXPECT_GT(untaken, 500U);
}

// From the fourth sample after a burst on, the truth is within 5 sd and nothing good is refused.
// Random offsets of up to 0.3 m may look like a motion: of 300 bursts of up to 4 samples at most 1
// is not found again (of 80 none), of 300 of 5 to 8 samples, where the motion restarts, at most 15.
// A burst of one offset that lasts is a step: the way back is one too.
TEST_P(Invariants, AfterABurstTheMotionIsFoundAgain) {
  std::uint64_t lost_after_short = 0, lost_after_long = 0;
  const auto seeds = testing_support::runs<std::uint64_t>(160, 600, 600);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Random random(seed);
    const auto course = any_chewing(random);
    const double noise_m = log_between(random, 3e-6, 300e-6);
    const double size_m = log_between(random, std::max(30 * noise_m, 1e-3), 0.3);
    const int shape = static_cast<int>(index_below(random, 5));
    const std::size_t length = 1 + index_below(random, 8);
    const auto start = static_cast<std::size_t>(5 * rate_Hz() * (1 + random.uniform()));
    const std::size_t end = start + length;
    Recording recording;
    for (std::size_t i = 0; i < end + 60; ++i) {
      const double t = static_cast<double>(i) / rate_Hz();
      const bool is_glitch = i >= start && i < end;
      const double offset_m = is_glitch ? burst_m(shape, size_m, i - start, random) : 0;
      recording.add(t, course(t), course(t) + offset_m + noise_m * random.normal());
    }
    const Estimates estimates = run(recording, rate_Hz());
    const bool is_found = is_followed(recording, estimates, end + 4, end + 60);
    (length <= 4 ? lost_after_short : lost_after_long) += !is_found;
  }
  EXPECT_LE(lost_after_short, seeds / 600);
  EXPECT_LE(lost_after_long, seeds / 40);
}

// Rest, then a movement of least jerk at up to 1 m/s: at most one sample is refused, and two in one
// of 150 onsets, where the whole movement takes three samples.
TEST_P(Invariants, AnOnsetCostsAtMostOneSample) {
  int costly = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    Random random(seed);
    const double noise_m = log_between(random, 3e-6, 300e-6);
    const double way_m = log_between(random, 2e-3, 50e-3);
    const double speed_m_s = log_between(random, 0.02, 1);
    const double duration_s = 1.875 * way_m / speed_m_s;
    const double rest_s = 2 + 4 * random.uniform();
    Recording recording;
    const auto count = static_cast<std::size_t>((rest_s + duration_s + 0.5) * rate_Hz());
    for (std::size_t i = 0; i < count; ++i) {
      const double t = static_cast<double>(i) / rate_Hz();
      const double truth = way_m * minimum_jerk((t - rest_s) / duration_s);
      recording.add(t, truth, truth + noise_m * random.normal());
    }
    const auto settled = static_cast<std::size_t>(rate_Hz());
    int refused = 0, restarted = 0;
    const Estimates estimates = run(recording, rate_Hz());
    for (std::size_t i = settled; i < count; ++i) {
      refused += estimates[i].events.has(Event::outlier_rejected);
      restarted += estimates[i].events.has(Event::state_restarted);
    }
    EXPECT_EQ(restarted, 0) << "seed " << seed;
    EXPECT_LE(refused, 2) << "seed " << seed << ", noise " << noise_m << ", way " << way_m
                          << ", speed " << speed_m_s;
    costly += refused > 1;
  }
  EXPECT_LE(costly, 1);
}

// Values that leap to and fro by up to 1 m leave nothing behind once they end.
TEST_P(Invariants, LeapsLeaveNothingBehind) {
  int lost = 0;
  const auto seeds = testing_support::runs<std::uint64_t>(50, 200, 200);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Random random(seed);
    const auto course = any_chewing(random);
    const double noise_m = log_between(random, 3e-6, 300e-6);
    const double size_m = log_between(random, std::max(30 * noise_m, 1e-3), 1);
    const int kind = static_cast<int>(index_below(random, 3));
    const auto start = static_cast<std::size_t>(3 * rate_Hz() * (1 + random.uniform()));
    const std::size_t end = start + 6 + index_below(random, 100);
    Recording recording;
    for (std::size_t i = 0; i < end + 100; ++i) {
      const double t = static_cast<double>(i) / rate_Hz();
      const std::size_t k = i - start;
      const bool leaps[] = {k % 2 == 0, k % 3 != 0, random.uniform() < 0.4};
      const bool is_off = i >= start && i < end && leaps[kind];
      recording.add(t, course(t), course(t) + (is_off ? size_m : 0) + noise_m * random.normal());
    }
    const Estimates estimates = run(recording, rate_Hz());
    const bool is_found = is_followed(recording, estimates, end + 30, end + 100);
    lost += !is_found;
  }
  EXPECT_EQ(lost, 0);
}

// The same motion sampled at T, T/2 and T/4: what leads is none of the bank's ends.
TEST(InvariantsOfTheBank, TheSameMotionLiesInsideTheBankAtAnyRate) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const auto course = any_chewing(random);
    const double noise_m = log_between(random, 3e-6, 100e-6);
    for (const double rate_Hz : {50.0, 100.0, 200.0, 400.0}) {
      RecommendedEstimator<double, 1> estimator(MotionEstimatorParameters{});
      RecommendedEstimate<double> estimate;
      for (TimeNs i = 0; i < static_cast<TimeNs>(10 * rate_Hz); ++i) {
        const double t = static_cast<double>(i) / rate_Hz;
        estimate =
            estimator.step({nanoseconds(t), true, {course(t) + noise_m * random.normal()}, {}});
      }
      EXPECT_FALSE(estimate.events.has(Event::liveliness_at_limit)) << seed << " " << rate_Hz;
      const double r =
          estimate.axes[0].jerk_density_m2_s5 / std::pow(estimate.axes[0].noise_sd_m, 2);
      const auto& bank = estimator.bank();
      EXPECT_GT(r, 1.01 * bank.ratio(0)) << seed << " " << rate_Hz;
      EXPECT_LT(r, 0.99 * bank.ratio(bank.member_count() - 1)) << seed << " " << rate_Hz;
    }
  }
}

}  // namespace
}  // namespace condyle::testing_support
