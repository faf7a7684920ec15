// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/outlier_gate.h"

#include "unit/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::number_between;

constexpr OutlierParameters kParameters{
    .huber_sd = 3, .gate_sd = 6, .reset_after = 5, .longest_gap_s = 0.25};

RC_GTEST_PROP(OutlierGate, TakesInFullThenLessThenNot, ()) {
  const double deviation = *number_between(0, 12);
  OutlierGate<double> gate(kParameters);
  const auto acceptance = gate.judge(deviation * deviation);
  RC_ASSERT(!acceptance.restart);
  RC_ASSERT(acceptance.events.has(Event::outlier_weighted) == (deviation > 3 && deviation <= 6));
  RC_ASSERT(acceptance.events.has(Event::outlier_rejected) == (deviation > 6));
  if (deviation <= 3) RC_ASSERT(acceptance.weight == 1.0);
  if (deviation > 3 && deviation <= 6) {
    RC_ASSERT(std::abs(acceptance.weight * deviation - 3) <= 1e-14);
  }
  if (deviation > 6) RC_ASSERT(acceptance.weight == 0.0);
  RC_ASSERT(gate.rejections() == (deviation > 6));
}

TEST(OutlierGate, ItsLimitsThemselvesStillCount) {
  OutlierGate<float> gate(kParameters);
  EXPECT_EQ(gate.judge(9).weight, 1);
  EXPECT_TRUE(gate.judge(9).events.empty());
  EXPECT_EQ(gate.judge(36).weight, 0.5F);
  EXPECT_EQ(gate.rejections(), 0);
}

TEST(OutlierGate, RejectsWhatIsNoNumber) {
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    OutlierGate<double> gate(kParameters);
    const auto acceptance = gate.judge(bad);
    EXPECT_EQ(acceptance.weight, 0);
    EXPECT_TRUE(acceptance.events.has(Event::outlier_rejected));
  }
}

TEST(OutlierGate, StartsAnewAfterSoManyInARow) {
  OutlierGate<double> gate(kParameters);
  for (int round = 0; round < 2; ++round) {
    for (int i = 1; i <= 5; ++i) {
      const auto acceptance = gate.judge(100);
      EXPECT_EQ(gate.rejections(), i);
      EXPECT_EQ(acceptance.restart, i == 5);
      EXPECT_EQ(acceptance.weight, 0);
    }
    gate.restart();
    EXPECT_EQ(gate.rejections(), 0);
  }
}

TEST(OutlierGate, OneGoodSampleForgetsTheRejected) {
  for (const double good : {0.0, 9.0, 16.0, 36.0}) {
    OutlierGate<double> gate(kParameters);
    for (int i = 0; i < 4; ++i) EXPECT_FALSE(gate.judge(100).restart);
    EXPECT_GT(gate.judge(good).weight, 0);
    EXPECT_EQ(gate.rejections(), 0);
    for (int i = 0; i < 4; ++i) EXPECT_FALSE(gate.judge(100).restart);
    EXPECT_TRUE(gate.judge(100).restart);
  }
}

}  // namespace
}  // namespace condyle
