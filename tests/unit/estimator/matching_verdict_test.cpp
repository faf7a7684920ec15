// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/published/matching_verdict.h"

#include <vector>

#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

// The definition, applied to the whole run.
Verdict verdict_by_definition(const std::vector<double>& masses, double m0) {
  for (const double m : masses) {
    if (!std::isfinite(m) || m <= 0) return Verdict::diverged;
  }
  const std::size_t quarter = (masses.size() + 3) / 4;
  for (std::size_t i = masses.size() - quarter; i < masses.size(); ++i) {
    if (std::abs(masses[i] - m0) > 0.02 * m0) return Verdict::not_matched;
  }
  return Verdict::matched;
}

RC_GTEST_PROP(MatchingCriterion, RunningVerdictIsThatOfTheWholeRun, ()) {
  const auto masses = *rc::gen::nonEmpty(rc::gen::container<std::vector<double>>(
      rc::gen::weightedElement<double>({{20, 0.25}, {4, 0.2549}, {1, 0.3}, {1, 0.1}})));
  MatchingCriterion criterion;
  std::vector<double> so_far;
  for (const double mass : masses) {
    so_far.push_back(mass);
    RC_ASSERT(criterion.add(mass, 0.25) == verdict_by_definition(so_far, 0.25));
  }
}

TEST(MatchingCriterion, DivergedStaysDiverged) {
  for (const double bad : {0.0, -0.6, std::nan(""), HUGE_VAL}) {
    MatchingCriterion criterion;
    EXPECT_EQ(criterion.add(0.25, 0.25), Verdict::matched);
    EXPECT_EQ(criterion.add(bad, 0.25), Verdict::diverged);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(criterion.add(0.25, 0.25), Verdict::diverged);
  }
}

}  // namespace
}  // namespace condyle
