// SPDX-License-Identifier: Apache-2.0
// The muscle model's factors, activation and geometry, each by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "condyle/estimator/emg/muscle_force.h"
#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

TEST(MuscleForce, FactorsHaveTheirShape) {
  const MuscleParameters muscle{100, 0.04, 0.04};  // l = 1 - q, w = -q' / 10
  EXPECT_EQ(force_length_factor(muscle, 0.0), 1);
  EXPECT_NEAR(force_length_factor(muscle, 0.45), std::exp(-1), 1e-15);
  EXPECT_EQ(force_velocity_factor(muscle, 0.0), 1);
  EXPECT_EQ(force_velocity_factor(muscle, 10.0), 0) << "as fast as it can shorten";
  EXPECT_NEAR(force_velocity_factor(muscle, -1e9), 1.4, 1e-6);
  const double h = 1e-6;
  const double shortening = (1 - force_velocity_factor(muscle, 10 * h)) / h;
  const double lengthening = (force_velocity_factor(muscle, -10 * h) - 1) / h;
  EXPECT_NEAR(shortening, 5, 1e-3);
  EXPECT_NEAR(lengthening, 5, 1e-3);
}

RC_GTEST_PROP(MuscleForce, ForceFallsWithTheSpeedOfShortening, (int first, int second)) {
  const MuscleParameters muscle;
  const double slow = std::min(first, second) % 100, fast = std::max(first, second) % 100;
  if (slow > fast) return;
  RC_ASSERT(force_velocity_factor(muscle, fast) <= force_velocity_factor(muscle, slow));
}

// The step of the activation is the solution of its differential equation.
RC_GTEST_PROP(MuscleForce, ActivationFollowsItsRate, ()) {
  const double a = *rc::gen::inRange(0, 101) / 100.0, e = *rc::gen::inRange(0, 101) / 100.0;
  const double after = activation_after(a, e, 0.005);
  double x = a;
  for (int i = 0; i < 5000; ++i) x += 1e-6 * activation_rate(x, e);
  RC_ASSERT(std::abs(after - x) < 1e-4);
  RC_ASSERT(activation_after(a, e, 1e3) == e);
}

TEST(JawGeometry, FindsTheCoordinateWithinReach) {
  const JawGeometry hinge;
  for (const double z : {0.001, 0.0, -0.01, -0.03, -0.04}) {
    ASSERT_TRUE(hinge.reaches(z));
    EXPECT_NEAR(hinge.position_m(hinge.coordinate_at(z)), z, 1e-15);
  }
  EXPECT_FALSE(hinge.reaches(-0.05));
  EXPECT_FALSE(hinge.reaches(0.2));
  EXPECT_FALSE(hinge.reaches(std::nan("")));
  EXPECT_FALSE(JawGeometry{JawMotion::translation}.reaches(std::nan("")));
}

}  // namespace
}  // namespace condyle
