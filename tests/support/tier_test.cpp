// SPDX-License-Identifier: Apache-2.0
#include "support/tier.h"

#include <gtest/gtest.h>

namespace condyle {
namespace {

using testing_support::Tier;
using testing_support::tier_of;

TEST(Tier, ReadsItsWord) {
  EXPECT_EQ(tier_of(nullptr), Tier::check);
  EXPECT_EQ(tier_of("check"), Tier::check);
  EXPECT_EQ(tier_of("full"), Tier::full);
  EXPECT_EQ(tier_of("release"), Tier::release);
}

TEST(Tier, AbortsAtAnUnknownWordAndNamesTheKnownOnes) {
  EXPECT_DEATH(tier_of("1"), "CONDYLE_TIER is \"1\": set it to check, full or release");
  EXPECT_DEATH(tier_of(""), "CONDYLE_TIER is \"\"");
}

TEST(Tier, AreInTheOrderOfTheirLength) {
  EXPECT_LT(Tier::check, Tier::full);
  EXPECT_LT(Tier::full, Tier::release);
}

}  // namespace
}  // namespace condyle
