// SPDX-License-Identifier: Apache-2.0
// What the clock fit says of itself, and clocks that step.
#include "condyle/hal/report/clock_fit.h"

#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "support/rapidcheck_gtest.h"

namespace condyle::hal {
namespace {

using testing_support::number_between;

constexpr double kLeastDelay_s = 1e-4, kPeriod_s = 0.002;
constexpr TimeNs kPeriod_ns = 2'000'000;

// Reports delayed by 0.1 ms at least and 0.2 ms more on average; they do not overtake.
class Reports {
 public:
  explicit Reports(std::uint64_t seed) : random_(seed) {}

  // Error of the time given to the report sent at `t`, when the device's clock stood at `device_s`.
  double add(ClockFit& fit, double t, double device_s) {
    last_arrival_s_ = std::max(last_arrival_s_, t + kLeastDelay_s + delay_(random_));
    return seconds(fit.add(nanoseconds(device_s), nanoseconds(last_arrival_s_))) - t -
           kLeastDelay_s;
  }

 private:
  std::mt19937_64 random_;
  std::exponential_distribution<double> delay_{1 / 2e-4};
  double last_arrival_s_ = 0;
};

TEST(ClockFitStep, SaysWhatTiesATimeToTheHost) {
  ClockFit fit;
  EXPECT_EQ(fit.add(7'000'000, 50'000'000), 50'000'000) << "the first report: its arrival";
  EXPECT_EQ(fit.outcome(), FitOutcome::started);
  EXPECT_EQ(fit.provenance(), TimeProvenance::host_arrival);
  EXPECT_DOUBLE_EQ(fit.uncertainty_s(), 1e-3) << "what delays may differ by";
  for (TimeNs i = 1; i < 2000; ++i) {
    const TimeNs device_ns = 7'000'000 + i * kPeriod_ns;
    const TimeNs time_ns = fit.add(device_ns, 50'000'000 + i * kPeriod_ns + (i % 3) * 100'000);
    ASSERT_EQ(fit.outcome(), FitOutcome::followed);
    ASSERT_EQ(fit.offset_ns(), time_ns - device_ns);
    const bool is_fitted = i * kPeriod_ns >= 1'000'000'000;
    ASSERT_EQ(fit.provenance(),
              is_fitted ? TimeProvenance::device_clock : TimeProvenance::host_arrival);
  }
}

// Errors of many runs of 40 s, drifts and heavy-tailed delays drawn anew (Pareto's, exponent
// `tail`).
struct Coverage {
  double covered = 0;  // share of times within three times the uncertainty
  double ratio = 0;    // of uncertainty and error at the end of a run: the ensemble's root mean
                       // squares

  Coverage(double rate_Hz, double tail) {
    constexpr int kRuns = 60;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform;
    double count = 0, error2 = 0, uncertainty2 = 0;
    for (int run = 0; run < kRuns; ++run) {
      const double drift = 4e-4 * uniform(random) - 2e-4;
      ClockFit fit;
      double last_arrival_s = 0, error_s = 0;
      for (double t = 0; t < 40; t += 1 / rate_Hz) {
        const double delay_s = 1e-4 * (std::pow(1 - uniform(random), -1 / tail) - 1);
        last_arrival_s = std::max(last_arrival_s, t + kLeastDelay_s + delay_s);
        const TimeNs time_ns =
            fit.add(nanoseconds(3 + t * (1 - drift)), nanoseconds(last_arrival_s));
        if (fit.provenance() == TimeProvenance::host_arrival) continue;
        error_s = seconds(time_ns) - t - kLeastDelay_s;
        ++count;
        covered += std::abs(error_s) <= 3 * fit.uncertainty_s() ? 1 : 0;
      }
      error2 += error_s * error_s;
      uncertainty2 += fit.uncertainty_s() * fit.uncertainty_s();
    }
    covered /= count;
    ratio = std::sqrt(uncertainty2 / error2);
  }
};

TEST(ClockFitStep, UncertaintyCoversTheErrorAndIsNotMuchLarger) {
  for (const double rate_Hz : {5.0, 50.0, 500.0}) {
    for (const double tail : {1.2, 2.0, 4.0}) {
      const Coverage coverage(rate_Hz, tail);
      EXPECT_GT(coverage.covered, 0.95) << rate_Hz << " Hz, tail " << tail;
      // Of delays of 1.2, one in a while holds up all of a second: a step is suspected.
      if (tail > 1.5) {
        EXPECT_LT(coverage.ratio, 5) << rate_Hz << " Hz, tail " << tail;
      }
    }
  }
}

RC_GTEST_PROP(ClockFitStep, StartsAnewAtOnceWhereTheDeviceRanAhead, ()) {
  const double step_s = *number_between(0.15, 1000), at_s = *number_between(2, 25);
  Reports reports(*rc::gen::arbitrary<std::uint64_t>());
  ClockFit fit;
  bool has_stepped = false;
  for (double t = 0; t < at_s + 3; t += kPeriod_s) {
    const double error_s = reports.add(fit, t, t < at_s ? t : t + step_s);
    if (!has_stepped && t >= at_s) {
      RC_ASSERT(fit.outcome() == FitOutcome::ran_ahead);
      RC_ASSERT(fit.provenance() == TimeProvenance::host_arrival);
      has_stepped = true;
    } else {
      RC_ASSERT(fit.outcome() == (t == 0 ? FitOutcome::started : FitOutcome::followed));
    }
    RC_ASSERT(std::abs(error_s) < 5e-3);
  }
  RC_ASSERT(fit.steps() == 1U);
}

RC_GTEST_PROP(ClockFitStep, StartsAnewWhereTheDeviceFellBehind, ()) {
  const double step_s = *number_between(0.15, 1000), at_s = *number_between(2, 25);
  Reports reports(*rc::gen::arbitrary<std::uint64_t>());
  ClockFit fit;
  double found_s = 0;
  for (double t = 0; t < at_s + step_s + 12; t += kPeriod_s) {
    // It stands for as long, and reports nothing meanwhile.
    if (t >= at_s && t < at_s + step_s) t = at_s + step_s;
    const double error_s = reports.add(fit, t, t < at_s ? t : t - step_s);
    if (fit.outcome() == FitOutcome::fell_behind) found_s = t;
    const bool is_wrong = t >= at_s && found_s == 0;
    RC_ASSERT(is_wrong || std::abs(error_s) < 5e-3);
    // It is said as soon as a second is over.
    if (is_wrong && t > at_s + step_s + 2.1) RC_ASSERT(fit.uncertainty_s() > 0.9 * step_s);
  }
  RC_ASSERT(found_s > at_s + step_s);
  RC_ASSERT(found_s < at_s + step_s + 6);
  RC_ASSERT(fit.steps() == 1U);
}

// The first report was held up, those after it less and less.
TEST(ClockFitStep, TakesNoCatchingUpForAStep) {
  ClockFit fit;
  for (TimeNs i = 0; i < 100; ++i) {
    const TimeNs late_ns = std::max<TimeNs>(150'000'000 - i * 15'000'000, 0);
    (void)fit.add(i * 20'000'000, i * 20'000'000 + late_ns);
    EXPECT_EQ(fit.outcome(), i == 0 ? FitOutcome::started : FitOutcome::followed) << i;
  }
}

// While nothing arrives the drift may have changed by 200 ppm.
TEST(ClockFitStep, TakesNoDriftWithinAPauseForAStep) {
  for (const double gained_s : {0.09, 0.25, 0.35}) {
    Reports reports(1);
    ClockFit fit;
    for (double t = 0; t < 20; t += kPeriod_s) reports.add(fit, t, t);
    reports.add(fit, 1020, 1020 + gained_s);
    const bool is_step = gained_s > 0.1 + 200e-6 * 1000 + 0.005;  // delays of some ms
    EXPECT_EQ(fit.outcome(), is_step ? FitOutcome::ran_ahead : FitOutcome::followed) << gained_s;
    EXPECT_EQ(fit.steps(), is_step ? 1U : 0U) << gained_s;
  }
}

// A clock 200 ppm fast or slow is a third of a second away after half an hour.
TEST(ClockFitStep, TakesNoDriftForAStep) {
  for (const double drift : {-2e-4, 2e-4}) {
    Reports reports(1);
    ClockFit fit;
    for (double t = 0; t < 1800; t += 0.05) reports.add(fit, t, t * (1 + drift));
    EXPECT_EQ(fit.steps(), 0U) << drift;
    EXPECT_EQ(fit.outcome(), FitOutcome::followed) << drift;
    EXPECT_LT(fit.uncertainty_s(), 0.01) << drift;
  }
}

TEST(ClockFitStep, SlewsAStepThatIsSmall) {
  Reports reports(1);
  ClockFit fit;
  double error_s = 0;
  for (double t = 0; t < 100; t += kPeriod_s) {
    error_s = reports.add(fit, t, t < 30 ? t : t + 0.02);
    ASSERT_LT(std::abs(error_s), 0.0205);
    // What is still to be slewed is part of the uncertainty. The fit takes 6 s to see it.
    if (t > 36 && std::abs(error_s) > 1e-3) {
      ASSERT_GT(fit.uncertainty_s(), 0.9 * std::abs(error_s)) << t;
    }
  }
  EXPECT_LT(std::abs(error_s), 1e-4);
  EXPECT_EQ(fit.steps(), 0U);
}

TEST(ClockFitStep, StartsAnewWhereTheDeviceWentBack) {
  ClockFit fit;
  for (TimeNs i = 0; i < 5000; ++i) {
    EXPECT_GT(fit.add(i * kPeriod_ns, i * kPeriod_ns + 100'000), 0);
  }
  const TimeNs now_ns = 5000 * kPeriod_ns + 100'000;
  EXPECT_EQ(fit.add(1000, now_ns), now_ns);
  EXPECT_EQ(fit.outcome(), FitOutcome::went_back);
  EXPECT_EQ(fit.steps(), 1U);
}

// Whatever the clocks say, time does not go back, and the same reports give the same times.
RC_GTEST_PROP(ClockFitStep, TakesAnyTimes, (const std::vector<std::pair<TimeNs, TimeNs>>& small)) {
  const auto any = *rc::gen::container<std::vector<std::pair<TimeNs, TimeNs>>>(rc::gen::pair(
      rc::gen::element(std::numeric_limits<TimeNs>::min(), std::numeric_limits<TimeNs>::max(),
                       TimeNs{0}, TimeNs{1'500'000'000}, TimeNs{4'000'000'000'000'000'000}),
      rc::gen::element(std::numeric_limits<TimeNs>::min(), std::numeric_limits<TimeNs>::max(),
                       TimeNs{-1}, TimeNs{2'500'000'000})));
  ClockFit fit, again;
  TimeNs last_ns = std::numeric_limits<TimeNs>::min();
  for (const auto& list : {small, any}) {
    for (const auto& [device_ns, arrival_ns] : list) {
      const TimeNs time_ns = fit.add(device_ns, arrival_ns);
      RC_ASSERT(time_ns >= last_ns);
      RC_ASSERT(std::isfinite(fit.uncertainty_s()));
      RC_ASSERT(again.add(device_ns, arrival_ns) == time_ns);
      RC_ASSERT(again.uncertainty_s() == fit.uncertainty_s());
      last_ns = time_ns;
    }
  }
}

}  // namespace
}  // namespace condyle::hal
