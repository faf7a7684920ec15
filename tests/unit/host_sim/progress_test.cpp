// SPDX-License-Identifier: Apache-2.0
#include "output/progress.h"

#include <gtest/gtest.h>

#include <limits>

namespace condyle::host {
namespace {

TEST(TimeLeft, FollowsThePace) {
  EXPECT_EQ(time_left_text(0, 0.5, 20), ", about 20 s left");
  EXPECT_EQ(time_left_text(0.5, 0.6, 30), ", about 2 min left");
  EXPECT_EQ(time_left_text(0.1, 0.11, 120), ", about 3.0 h left");
  EXPECT_EQ(time_left_text(0.9, 1, 5), ", about 0 s left");
}

TEST(TimeLeft, IsNotGuessed) {
  EXPECT_EQ(time_left_text(0, 0.5, 1), "");    // too short to know
  EXPECT_EQ(time_left_text(0.5, 0.5, 9), "");  // nothing done
  EXPECT_EQ(time_left_text(0.5, 0.4, 9), "");
  EXPECT_EQ(time_left_text(0.5, std::numeric_limits<double>::quiet_NaN(), 9), "");
}

}  // namespace
}  // namespace condyle::host
