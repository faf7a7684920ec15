// SPDX-License-Identifier: Apache-2.0
// The gate on real recordings. Nothing here is random. The recordings are not part of the project:
// without CONDYLE_REFERENCE_DATA these tests skip.
#include <gtest/gtest.h>

#include <iostream>

#include "real_motion/score.h"
#include "support/tier.h"

namespace condyle::testing_support {
namespace {

// Bounds of what users of real instruments must not meet more often.
constexpr double kMostRefused_percent = 0.5, kMostRefusedWithFaults_percent = 0.7;
constexpr double kMostErrorRatio = 1.15, kMostErrorRatio95th = 2.0;
constexpr double kLeastCoverage = 0.93, kMostCoverage = 0.98;

void print(const Summary& summary) {
  std::cout << "             " << summary.axes << " axes, velocity error over the oracle's "
            << summary.error_ratio << ", 95th percentile " << summary.error_ratio_95th
            << ", coverage of velocity " << summary.velocity_coverage << ", of the next sample "
            << summary.next_coverage << ", refused " << summary.refused_percent << " %, runaways "
            << summary.runaways << ", deviation falls " << summary.deviation_falls << '\n';
}

void expect_good(const Summary& summary, bool has_faults) {
  EXPECT_EQ(summary.runaways, 0U);
  EXPECT_EQ(summary.deviation_falls, 0U);
  EXPECT_LE(summary.refused_percent,
            has_faults ? kMostRefusedWithFaults_percent : kMostRefused_percent);
  for (const double coverage : {summary.velocity_coverage, summary.next_coverage}) {
    EXPECT_GE(coverage, kLeastCoverage);
    EXPECT_LE(coverage, kMostCoverage);
  }
  if (has_faults) return;  // the oracle bridges 0.5 s by prediction: no yardstick
  EXPECT_LE(summary.error_ratio, kMostErrorRatio);
  EXPECT_LE(summary.error_ratio_95th, kMostErrorRatio95th);
}

class RealMotion : public testing::TestWithParam<Treatment> {};

std::string test_name(const testing::TestParamInfo<Treatment>& info) {
  std::string name = name_of(info.param);
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}
INSTANTIATE_TEST_SUITE_P(Recordings, RealMotion, testing::ValuesIn(kTreatments), test_name);

TEST_P(RealMotion, IsWithinTheBounds) {
  const auto recordings = read_real_recordings();
  if (recordings.empty())
    GTEST_SKIP() << "set CONDYLE_REFERENCE_DATA to the folder of reference data";
  const bool has_faults = GetParam() == Treatment::faults;
  const unsigned draws = has_faults ? runs(1U, 4U, 16U) : 1;
  for (unsigned seed = 1; seed <= draws; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto scores = score_all(recordings, GetParam(), seed);
    const Summary summary = summarise(scores, &AxisScores::recommended);
    print(summary);
    expect_good(summary, has_faults);
    for (const AxisScores& axis : scores) {
      EXPECT_EQ(axis.recommended.places, "") << axis.recording << ' ' << axis.axis;
    }
  }
}

}  // namespace
}  // namespace condyle::testing_support
