// SPDX-License-Identifier: Apache-2.0
// The columns of the fits, and what an unknown delay does to their values.
#include "condyle/estimator/impedance/point_candidate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace condyle::internal {
namespace {

using Columns = std::set<RegressionColumn>;

Columns set_of(const FitColumns& fit) {
  Columns columns(fit.columns.begin(), fit.columns.begin() + fit.count);
  EXPECT_EQ(columns.size(), fit.count) << "a column twice has no inverse";
  return columns;
}
Columns less(Columns columns, RegressionColumn left_out) {
  columns.erase(left_out);
  return columns;
}
Columns with(Columns columns, RegressionColumn added) {
  columns.insert(added);
  return columns;
}

TEST(PointColumns, DifferFromTheFullFitsByWhatTheirNamesSay) {
  for (const DelayModel delay : {DelayModel::known, DelayModel::fitted}) {
    for (const MassModel mass : {MassModel::known, MassModel::fitted}) {
      ImpedanceParameters parameters;
      parameters.delay = delay;
      parameters.mass = mass;
      const PointColumns columns(parameters);
      const Columns plain = set_of(columns.of(false, false, false));
      EXPECT_EQ(plain.count(kAccelerationColumn), mass == MassModel::fitted ? 1U : 0U);
      EXPECT_EQ(plain.count(kDriveSlopeColumn), delay == DelayModel::fitted ? 1U : 0U);
      for (const auto column : {kVelocityColumn, kPositionColumn, kOneColumn}) {
        EXPECT_EQ(plain.count(column), 1U);
      }
      const Columns extended = set_of(columns.of(true, true, true));
      Columns expected = plain;
      expected.insert({kSquareColumn, kCubeColumn, kFourthColumn, kSignColumn});
      EXPECT_EQ(extended, expected);
      EXPECT_EQ(set_of(columns.without_spring()), less(plain, kPositionColumn));
      EXPECT_EQ(set_of(columns.without_delay()), less(plain, kDriveSlopeColumn));
      EXPECT_EQ(set_of(columns.late()), with(extended, kDriveSlopeColumn));
      EXPECT_EQ(set_of(columns.curved()),
                with(with(extended, kAccelerationColumn), kDriveCurvatureColumn));
    }
  }
}

// A delay's normal error e moves a value by `per_delay` e + `per_delay2` e^2 / 2.
TEST(Candidate, AddsTheMeanSquareOfWhatADelayDoes) {
  constexpr double kDelaySd_s = 0.005, kStep = 1e-3;
  for (const double per_delay : {0.0, -20.0, 300.0}) {
    for (const double per_delay2 : {0.0, 1e4, -3e5}) {
      Candidate candidate;
      candidate.fit.per_delay = per_delay;
      candidate.fit.per_delay2 = per_delay2;
      candidate.fit.sd = 0.2;
      candidate.discrepancy2 = 0.09;
      double mean_square = 0, weights = 0;
      for (double z = -10; z < 10; z += kStep) {
        const double error_s = kDelaySd_s * z, weight = std::exp(-z * z / 2);
        const double effect = per_delay * error_s + per_delay2 * error_s * error_s / 2;
        mean_square += weight * effect * effect;
        weights += weight;
      }
      mean_square /= weights;
      EXPECT_NEAR(candidate.delay2(kDelaySd_s), mean_square, 1e-6 * mean_square);
      EXPECT_NEAR(candidate.all2(kDelaySd_s), 0.04 + 0.09 + mean_square, 1e-6);
    }
  }
}

}  // namespace
}  // namespace condyle::internal
