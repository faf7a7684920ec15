// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/motion/outlier_gate.h"

#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::number_between;

constexpr OutlierParameters kParameters{
    .huber_sd = 3, .gate_sd = 6, .reset_after = 5, .longest_gap_s = 0.25};

RC_GTEST_PROP(OutlierGate, TakesInFullThenLessThenNot, ()) {
  const double deviation = *number_between(0, 12);
  const OutlierGate<double> gate(kParameters);
  const double square = deviation * deviation;
  RC_ASSERT(gate.is_doubtful(square) == (deviation > 3));
  RC_ASSERT(gate.is_outlier(square) == (deviation > 6));
  if (deviation <= 3) RC_ASSERT(gate.weight(square) == 1.0);
  if (deviation > 3) RC_ASSERT(std::abs(gate.weight(square) * deviation - 3) <= 1e-14);
}

TEST(OutlierGate, ItsLimitsThemselvesStillCount) {
  const OutlierGate<float> gate(kParameters);
  EXPECT_EQ(gate.weight(9), 1);
  EXPECT_FALSE(gate.is_doubtful(9));
  EXPECT_EQ(gate.weight(36), 0.5F);
  EXPECT_FALSE(gate.is_outlier(36));
}

TEST(OutlierGate, WhatIsNoNumberIsAnOutlier) {
  const OutlierGate<double> gate(kParameters);
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    EXPECT_TRUE(gate.is_outlier(bad));
    EXPECT_TRUE(gate.is_doubtful(bad));
  }
}

}  // namespace
}  // namespace condyle
