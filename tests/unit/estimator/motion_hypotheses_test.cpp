// SPDX-License-Identifier: Apache-2.0
// The two hypotheses about unexpected samples: what follows from one does not depend on when it
// comes.
#include "condyle/estimator/motion/motion_hypotheses.h"

#include <gtest/gtest.h>

#include <cmath>

namespace condyle {
namespace {

struct Motion {
  explicit Motion(const MotionEstimatorParameters& parameters) : hypotheses(parameters) {
    hypotheses.start_noise({parameters.noise.position_sd_m});
    hypotheses.start_motion({0});
  }
  SampleVerdict<double, 1> take(double z_m, double T) {
    hypotheses.predict(T, white_jerk_jacobian(T), white_jerk_covariance(T));
    return hypotheses.take({z_m}, T);
  }
  MotionHypotheses<double, 1> hypotheses;
};

// A point stands still, of known noise, for `still` samples, then moves at once.
Motion begun_after(int still, double T, double velocity_m_s) {
  MotionEstimatorParameters parameters;
  parameters.noise.adaptation = Adaptation::off;
  Motion motion(parameters);
  for (int i = 0; i < still; ++i) motion.take(0, T);
  motion.take(velocity_m_s * T, T);
  return motion;
}

TEST(MotionHypotheses, AChangeIsTheSameEarlyAndLate) {
  for (const double T : {0.002, 0.01, 0.02}) {
    for (const double velocity_m_s : {0.1, 0.5, 2.0}) {
      Motion early = begun_after(60, T, velocity_m_s), late = begun_after(3000, T, velocity_m_s);
      for (int i = 2; i < 8; ++i) {
        const auto of_early = early.hypotheses.moments(0), of_late = late.hypotheses.moments(0);
        for (int k = 0; k < 3; ++k) {
          EXPECT_NEAR(of_early.variance[k] / of_late.variance[k], 1, 0.01) << i << ": " << k;
          EXPECT_NEAR(of_early.mean[k], of_late.mean[k], 0.02 * std::sqrt(of_late.variance[k]))
              << i << ": " << k;
        }
        EXPECT_NEAR(early.hypotheses.onset_variance(0.01, 1e-8, T) /
                        late.hypotheses.onset_variance(0.01, 1e-8, T),
                    1, 0.01);
        early.take(velocity_m_s * T * i, T);
        late.take(velocity_m_s * T * i, T);
      }
    }
  }
}

}  // namespace
}  // namespace condyle
