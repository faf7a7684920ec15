// SPDX-License-Identifier: Apache-2.0
// The first sample of a motion after a rest: it is taken, and its velocity is not known yet.
#include <gtest/gtest.h>

#include <cmath>

#include "condyle/estimator/motion/recommended_estimator.h"
#include "support/random.h"

namespace condyle {
namespace {

// Rests for 10 s, then moves at once: the first sample is `sds` standard deviations of the noise
// away, within the gate. The errors of the shown velocity and their standard deviations, at the
// last sample of the rest and the first of the motion.
struct Onset {
  double error_m_s[2], sd_m_s[2];
  bool is_taken = false;

  Onset(double sds, double rate_Hz, double noise_m, std::uint64_t seed) {
    testing_support::Random random(seed);
    RecommendedEstimator<double, 1> estimator({});
    RecommendedEstimate<double> estimate;
    double velocity_m_s = 0;
    const auto step = [&](int i, double z_m) {
      estimate = estimator.step({nanoseconds(i / rate_Hz), true, {z_m}, {}});
      const auto& velocity = estimate.axes[0].velocity_m_s;
      error_m_s[velocity_m_s != 0 ? 1 : 0] = velocity.value - velocity_m_s;
      sd_m_s[velocity_m_s != 0 ? 1 : 0] = velocity.standard_deviation;
    };
    const int rest = static_cast<int>(10 * rate_Hz);
    for (int i = 0; i < rest; ++i) step(i, noise_m * random.normal());
    const double way_m = sds * estimate.axes[0].noise_sd_m;
    velocity_m_s = way_m * rate_Hz;
    step(rest, estimate.axes[0].position_m.value + way_m);
    is_taken = !estimate.events.has(Event::outlier_rejected) &&
               !estimate.events.has(Event::motion_changed);
  }
};

TEST(MotionOnset, AVelocityThatMayHaveBegunIsInItsInterval) {
  for (const double rate_Hz : {60.0, 100.0, 200.0}) {
    for (const double noise_m : {1e-5, 5e-5}) {
      for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const Onset onset(5.2, rate_Hz, noise_m, seed);
        EXPECT_LT(std::abs(onset.error_m_s[0]), 4.5 * onset.sd_m_s[0]);
        ASSERT_TRUE(onset.is_taken);
        EXPECT_LT(std::abs(onset.error_m_s[1]), kNormalQuantile95 * onset.sd_m_s[1])
            << rate_Hz << " Hz, " << noise_m << " m, " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace condyle
