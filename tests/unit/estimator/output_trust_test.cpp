// SPDX-License-Identifier: Apache-2.0
// How far predicted errors are trusted: by the share of them that comes out.
#include "condyle/estimator/motion/output_trust.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace condyle {
namespace {

using testing_support::Random;

constexpr double kStep_s = 0.01;

// After 20 s of predictions of which the share `share` comes out, beside noise.
double alpha_of(double share, double noise, Random& random) {
  OutputTrust<double> trust;
  for (int k = 0; k < 2000; ++k) {
    const double predicted = random.normal();
    trust.add(share * predicted + noise * random.normal(), predicted, 1, kStep_s);
  }
  return trust.alpha();
}
double beta_of(double share, double noise, Random& random) {
  PositionTrust<double> trust;
  for (int k = 0; k < 2000; ++k) {
    const double predicted = random.normal();
    trust.add(share * predicted + noise * random.normal(), predicted, kStep_s);
  }
  return trust.beta();
}

// Of noisy errors alpha is a lower and beta an upper bound, which noise of four standard deviations
// passes by the margins here.
TEST(OutputTrust, IsTheShareThatComesOut) {
  Random random(1);
  for (const double share : {0.0, 0.3, 0.7, 1.0}) {
    EXPECT_NEAR(alpha_of(share, 0, random), share, 1e-6);
    EXPECT_NEAR(beta_of(share, 0, random), share, 0.2);
    EXPECT_LE(alpha_of(share, 1, random), share + 0.1);
    EXPECT_GE(beta_of(share, 1, random), share - 0.2);
  }
}

TEST(OutputTrust, IsNoneIfTheOppositeComesOutAndWholeIfMoreDoes) {
  Random random(2);
  EXPECT_EQ(alpha_of(-1, 0.1, random), 0);
  EXPECT_EQ(beta_of(-1, 0.1, random), 0);
  EXPECT_EQ(alpha_of(3, 0.1, random), 1);
  EXPECT_EQ(beta_of(3, 0.1, random), 1);
}

// What was never tried is not trusted for a teacher's outputs; positions do not contradict it.
TEST(OutputTrust, OfNothingIsThatOfNoEvidence) {
  OutputTrust<double> trust;
  PositionTrust<double> positions;
  EXPECT_EQ(trust.alpha(), 0);
  EXPECT_EQ(positions.beta(), 1);
  for (int k = 0; k < 2000; ++k) {
    trust.add(1, 0, 1, kStep_s);
    positions.add(1, 0, kStep_s);
  }
  EXPECT_EQ(trust.alpha(), 0);
  EXPECT_EQ(positions.beta(), 1);
}

}  // namespace
}  // namespace condyle
