// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/clock_fit.h"

#include <cmath>
#include <functional>
#include <iostream>
#include <random>
#include <vector>

#include "support/rapidcheck_gtest.h"

namespace condyle::hal {
namespace {

// A device whose clock runs at `rate(t)` of true time, read over a bus that delays each report by
// 0.1 ms at least, 0.2 ms more on average, and in 1 % of cases by up to 20 ms.
struct Bus {
  double rate_Hz = 500;
  std::function<double(double)> device_s = [](double t) { return t; };
  std::mt19937_64 random{1};

  struct Error {
    double rms_s = 0, largest_s = 0, arrival_rms_s = 0, step_rms_s = 0;
  };

  // Errors after `from_s`, against the truth plus the least delay.
  Error run(ClockFit& fit, double duration_s, double from_s) {
    std::exponential_distribution<double> usual(1 / 2e-4);
    std::uniform_real_distribution<double> uniform;
    Error error;
    double count = 0, last_arrival_s = 0;
    TimeNs last_ns = 0;
    for (double t = 0; t < duration_s; t += 1 / rate_Hz) {
      double delay_s = 1e-4 + usual(random);
      if (uniform(random) < 0.01) delay_s += 0.02 * uniform(random);
      last_arrival_s = std::max(last_arrival_s, t + delay_s);  // reports do not overtake
      const TimeNs time_ns = fit.add(nanoseconds(1000 + device_s(t)), nanoseconds(last_arrival_s));
      EXPECT_GE(time_ns, last_ns);
      if (t >= from_s) {
        const double miss_s = seconds(time_ns) - (t + 1e-4);
        error.rms_s += miss_s * miss_s;
        error.largest_s = std::max(error.largest_s, std::abs(miss_s));
        error.arrival_rms_s += std::pow(last_arrival_s - t - 1e-4, 2);
        error.step_rms_s += std::pow(seconds(time_ns - last_ns) - 1 / rate_Hz, 2);
        ++count;
      }
      last_ns = time_ns;
    }
    for (double* value : {&error.rms_s, &error.arrival_rms_s, &error.step_rms_s}) {
      *value = std::sqrt(*value / count);
    }
    return error;
  }
};

RC_GTEST_PROP(ClockFit, FollowsOffsetAndDriftThroughJitter, ()) {
  const double drift_ppm = *testing_support::number_between(-200, 200);
  Bus bus;
  bus.rate_Hz = *rc::gen::element(50.0, 100.0, 500.0);
  bus.random.seed(*rc::gen::arbitrary<std::uint64_t>());
  bus.device_s = [&](double t) { return t * (1 - 1e-6 * drift_ppm); };
  ClockFit fit;
  const Bus::Error error = bus.run(fit, 60, 20);
  RC_ASSERT(error.rms_s < 3e-5);
  RC_ASSERT(error.rms_s < 0.05 * error.arrival_rms_s);
  RC_ASSERT(error.step_rms_s < 1e-5);
  RC_ASSERT(std::abs(fit.drift_ppm() - drift_ppm) < 10);
  RC_ASSERT(fit.residual_s() < 5e-5);
  RC_ASSERT(fit.seconds_fitted() == 16);
}

// The true drift lies within three of the stated standard deviations, however long was fitted: of
// 400 runs 2 % may miss it (the spread is told from as few as three seconds). Delays as above, and
// arrivals that wait for the next of frames of 1 ms, with which the device's clock beats.
TEST(ClockFit, SaysHowSureTheDriftIs) {
  for (const double frame_s : {0.0, 1e-3}) {
    int misses = 0;
    double square = 0;
    for (unsigned seed = 1; seed <= 400; ++seed) {
      std::mt19937_64 random(seed);
      const double drift_ppm = std::uniform_real_distribution<double>(-200, 200)(random);
      const double duration_s = std::uniform_real_distribution<double>(5, 25)(random);
      std::exponential_distribution<double> usual(1 / 2e-4);
      ClockFit fit;
      for (double device_s = 0; device_s < duration_s; device_s += 0.002) {
        const double t = device_s / (1 - 1e-6 * drift_ppm);
        double arrival_s = t + 1e-4 + usual(random);
        if (frame_s > 0) arrival_s = frame_s * std::ceil(arrival_s / frame_s);
        (void)fit.add(nanoseconds(1000 + device_s), nanoseconds(arrival_s));
      }
      const double error = (fit.drift_ppm() - drift_ppm) / fit.drift_uncertainty_ppm();
      misses += std::abs(error) > 3 ? 1 : 0;
      square += error * error;
    }
    EXPECT_LE(misses, 8) << frame_s;
    // With the frames, which it allows for, it is not much larger than the error. The rms of 400
    // varies by 4 %.
    if (frame_s > 0) {
      EXPECT_GT(std::sqrt(square / 400), 0.7);
      EXPECT_LT(std::sqrt(square / 400), 1.3);
    }
    std::cout << "             frames of " << frame_s << " s: rms " << std::sqrt(square / 400)
              << " standard deviations, " << misses << " of 400 beyond 3\n";
  }
}

// A unit that is wrong by ten shows, whichever way.
TEST(ClockFit, TellsTheDevicesPace) {
  for (const double pace : {0.1, 1.0, 10.0}) {
    ClockFit fit;
    EXPECT_EQ(fit.pace(), 0);
    for (double t = 0; t < 8; t += 0.002) {
      (void)fit.add(nanoseconds(1000 + pace * t), nanoseconds(t + 1e-4));
    }
    EXPECT_NEAR(fit.pace(), pace, 1e-3 * pace);
  }
}

// A crystal that warms up: 20 ppm within a minute.
TEST(ClockFit, FollowsADriftThatChanges) {
  Bus bus;
  bus.device_s = [](double t) { return t - 20e-6 * (t - 20 * (1 - std::exp(-t / 20))); };
  ClockFit fit;
  EXPECT_LT(bus.run(fit, 120, 10).largest_s, 1e-4);
}

TEST(ClockFit, IsNotMisledByAFirstReportThatIsLate) {
  ClockFit fit;
  TimeNs late_ns = 0;
  for (TimeNs i = 0; i < 10'000; ++i) {
    const TimeNs true_ns = i * 2'000'000;
    late_ns = fit.add(true_ns, true_ns + (i < 10 ? 20'000'000 - 2'000'000 * i : 100'000)) - true_ns;
    // The time between samples is never off by more than the slew of 0.1 %.
    if (i == 20) {
      EXPECT_NEAR(static_cast<double>(late_ns), 20e6, 1e6);
    }
  }
  EXPECT_NEAR(static_cast<double>(late_ns), 1e5, 2e4) << "20 s later it has gone";
}

TEST(ClockFit, BridgesPausesAndBursts) {
  Bus bus;
  ClockFit fit;
  bus.run(fit, 20, 0);
  // Nothing arrives for 5 s, then everything at once.
  const TimeNs end_ns = nanoseconds(25);
  for (double t = 20; t < 25; t += 0.002) {
    const TimeNs time_ns = fit.add(nanoseconds(1000 + t), end_ns);
    ASSERT_NEAR(seconds(time_ns), t + 1e-4, 2e-4);
  }
  EXPECT_EQ(fit.steps(), 0U) << "reports that were held up are no step of a clock";
}

TEST(ClockFit, StartsAnewAfterTheClockWasSetAndStaysMonotone) {
  ClockFit fit;
  TimeNs last_ns = 0;
  for (TimeNs i = 0; i < 5000; ++i) last_ns = fit.add(i * 2'000'000, i * 2'000'000 + 100'000);
  fit.restart();
  for (TimeNs i = 5000; i < 10'000; ++i) {
    const TimeNs time_ns = fit.add(i, i * 2'000'000 + 100'000);
    ASSERT_GE(time_ns, last_ns);
    last_ns = time_ns;
    if (i == 5000) {
      EXPECT_EQ(time_ns, 5000 * TimeNs{2'000'000} + 100'000);
    }
  }
}

}  // namespace
}  // namespace condyle::hal
