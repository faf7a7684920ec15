// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/motion/unseen_change.h"

#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

constexpr double kAcceleration_m_s2 = 2, kVelocity_m_s = 0.1;
const UnseenChange<double> kJaw(kAcceleration_m_s2* kAcceleration_m_s2,
                                kVelocity_m_s* kVelocity_m_s);

TEST(UnseenChange, AddsNothingWithoutAGap) {
  EXPECT_EQ(kJaw.in_gap(0).norm(), 0);
}

// 10 ms: probability 0.02, 2 m/s^2, 20 mm/s, 0.1 mm. 0.2 s: 0.4, the velocity is the jaw's.
TEST(UnseenChange, InAGapIsThePriorsMotion) {
  const Vector3<double> early = kJaw.in_gap(0.01), late = kJaw.in_gap(0.2);
  EXPECT_NEAR(early[0], 0.02 * 1e-4 * 1e-4, 1e-15);
  EXPECT_NEAR(early[1], 0.02 * 0.02 * 0.02, 1e-12);
  EXPECT_NEAR(early[2], 0.02 * 4, 1e-12);
  EXPECT_NEAR(late[0], 0.4 * 0.01 * 0.01, 1e-12);
  EXPECT_NEAR(late[1], 0.4 * 0.1 * 0.1, 1e-12);
}

RC_GTEST_PROP(UnseenChange, GrowsWithTheGap, ()) {
  const double t = std::pow(10, *testing_support::number_between(-4, 1));
  const Vector3<double> one = kJaw.in_gap(t), longer = kJaw.in_gap(1.1 * t);
  for (int i = 0; i < 3; ++i) RC_ASSERT(longer[i] >= one[i]);
}

// Between 0, for a sample that is as expected, and the whole of the velocity that reaches it.
RC_GTEST_PROP(UnseenChange, AtAnOnsetGrowsWithTheSurprise, ()) {
  const double T = std::pow(10, *testing_support::number_between(-4, -1));
  const double sd_m = std::pow(10, *testing_support::number_between(-7, -3));
  RC_ASSERT(kJaw.at_onset(1.99 * sd_m, sd_m * sd_m, T) == 0);
  double last = 0;
  for (double d = 2.01; d < 40; d *= 1.1) {
    const double added = kJaw.at_onset(d * sd_m, sd_m * sd_m, T);
    RC_ASSERT(added > last);
    RC_ASSERT(added <= 1.000001 * std::pow(1.5 * d * sd_m / T, 2));
    RC_ASSERT(added == kJaw.at_onset(-d * sd_m, sd_m * sd_m, T));
    last = added;
  }
}

// 6 standard deviations of a noise of 10 um are 60 um: at 100 Hz of a jaw no outlandish motion.
TEST(UnseenChange, AtAnOnsetAFarSampleIsOfAnotherMotion) {
  const double d = 60e-6, change_m_s = 1.5 * d / 0.01;
  EXPECT_NEAR(kJaw.at_onset(d, 1e-10, 0.01), change_m_s * change_m_s,
              1e-3 * change_m_s * change_m_s);
  EXPECT_EQ(kJaw.at_onset(d, 1e-10, 0), 0);
}

}  // namespace
}  // namespace condyle
