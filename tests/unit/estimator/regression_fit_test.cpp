// SPDX-License-Identifier: Apache-2.0
// The fit of blocks against independent evaluations: its inverse, its residual, its trend.
#include "condyle/estimator/impedance/regression_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <vector>

#include "support/random.h"

namespace condyle {
namespace {

using testing_support::Random;
using Instant = std::array<double, kRegressionColumns>;

// Blocks of ten instants.
class Recording {
 public:
  static constexpr int kInstantsPerBlock = 10;

  void add(const Instant& columns, double drive_variance_N2 = 0) {
    RegressionSums<double>& block = blocks_->open();
    block.add_instant(columns);
    block.position_noise.add(NoiseSums<double>{0, 1});
    block.drive_noise.add(NoiseSums<double>{drive_variance_N2, 1});
    blocks_->close_if_full();
    instants.push_back(columns);
  }
  RegressionData<double> data(const RegressionSetup& setup) const { return {*blocks_, setup, 0}; }

  std::vector<Instant> instants;

 private:
  std::unique_ptr<RegressionBlocks<double>> blocks_ =
      std::make_unique<RegressionBlocks<double>>(0.5 / kInstantsPerBlock);
};

FitColumns columns_of(std::initializer_list<RegressionColumn> list) {
  FitColumns columns;
  for (const RegressionColumn column : list) columns.add(column);
  return columns;
}

// Columns of very different units, as mass, friction and stiffness have.
TEST(RegressionFit, InvertsTheLeadingRowsAndTouchesNoOthers) {
  constexpr double kUntouched = 7;
  Random random(1);
  for (std::size_t size = 1; size <= kMostFitted; ++size) {
    const auto n = static_cast<Eigen::Index>(size);
    Eigen::MatrixXd Y(40, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const double unit = std::pow(10, 4 * random.uniform() - 2);
      for (Eigen::Index i = 0; i < 40; ++i) Y(i, j) = unit * random.normal();
    }
    const Eigen::MatrixXd A = Y.transpose() * Y;
    internal::FitMatrix matrix{}, inverse;
    for (auto& row : inverse) row.fill(kUntouched);
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j < size; ++j) {
        matrix[i][j] = A(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      }
    }
    ASSERT_TRUE(internal::invert_leading(matrix, size, inverse)) << size;
    const Eigen::MatrixXd expected = A.inverse();
    for (std::size_t i = 0; i < kMostFitted; ++i) {
      for (std::size_t j = 0; j < kMostFitted; ++j) {
        const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
        if (i < size && j < size) {
          EXPECT_NEAR(inverse[i][j], expected(row, column),
                      1e-9 * std::sqrt(expected(row, row) * expected(column, column)));
        } else {
          EXPECT_EQ(inverse[i][j], kUntouched) << size << ": " << i << ", " << j;
        }
      }
    }
  }
}

TEST(RegressionFit, HasNoInverseOfDependentColumns) {
  internal::FitMatrix inverse{};
  EXPECT_FALSE(internal::invert_leading({{{4, 2}, {2, 1}}}, 2, inverse));
  EXPECT_FALSE(internal::invert_leading({{{1, 0}, {0, -1}}}, 2, inverse));
  EXPECT_FALSE(internal::invert_leading({{{1, 0}, {0, 0}}}, 2, inverse));
}

// The residual of the drive moved back by the fitted delay, to second order, summed instant by
// instant; over the variance of the same combination of u, u' and u''.
TEST(RegressionFit, ResidualIsThatOfTheDriveMovedBack) {
  constexpr double kDelay_s = 0.3, kVariance_N2 = 0.01;
  RegressionSetup setup;
  setup.drive = {1, 0.5, 2};
  Random random(2);
  Recording recording;
  for (int k = 0; k < 400; ++k) {
    Instant y{};
    for (const auto column : {kVelocityColumn, kPositionColumn, kDriveSlopeColumn}) {
      y[column] = random.normal();
    }
    y[kOneColumn] = 1;
    y[kDriveCurvatureColumn] = 3 * random.normal();
    y[kDriveColumn] = 0.5 * y[kVelocityColumn] + 2 * y[kPositionColumn] - 0.3 -
                      kDelay_s * y[kDriveSlopeColumn] -
                      kDelay_s * kDelay_s / 2 * y[kDriveCurvatureColumn] +
                      std::sqrt(kVariance_N2) * random.normal();
    recording.add(y, kVariance_N2);
  }
  const RegressionData<double> data = recording.data(setup);
  const RegressionFit<double> fit(
      data, columns_of({kVelocityColumn, kPositionColumn, kOneColumn, kDriveSlopeColumn}));
  ASSERT_TRUE(fit.is_solved());
  const double tau = fit.value(kDriveSlopeColumn), bend = tau * tau / 2;
  EXPECT_NEAR(tau, kDelay_s, 0.02);
  double squares = 0;
  for (const Instant& y : recording.instants) {
    const double e = y[kDriveColumn] + tau * y[kDriveSlopeColumn] +
                     bend * y[kDriveCurvatureColumn] -
                     fit.value(kVelocityColumn) * y[kVelocityColumn] -
                     fit.value(kPositionColumn) * y[kPositionColumn] - fit.value(kOneColumn);
    squares += e * e;
  }
  const double per_instant = setup.drive.G0 + tau * tau * setup.drive.G2 +
                             bend * bend * setup.drive.G4 - 2 * bend * setup.drive.G2;
  EXPECT_NEAR(fit.residual() / (squares / (400 * kVariance_N2 * per_instant)), 1, 0.01);
}

// A recording whose motion grows: most of its information is near its end. `rise`: change of the
// friction from begin to end.
FittedValue friction_of(double rise, Random& random) {
  constexpr int kInstants = 40 * Recording::kInstantsPerBlock;
  Recording recording;
  for (int k = 0; k < kInstants; ++k) {
    const double share = k / static_cast<double>(kInstants);
    Instant y{};
    y[kVelocityColumn] = 0.05 * share * random.normal();
    y[kOneColumn] = 1;
    y[kDriveColumn] = (0.5 + rise * share) * y[kVelocityColumn] - 0.2 + 0.01 * random.normal();
    recording.add(y);
  }
  const RegressionSetup setup;
  const RegressionData<double> data = recording.data(setup);
  return RegressionFit<double>(data, columns_of({kVelocityColumn, kOneColumn}))
      .fitted(kVelocityColumn);
}

// The mean of 300 squares of standard deviation 1 leaves the range by chance once in 10^4 seeds.
TEST(RegressionFit, TrendOfAConstantHasTheVarianceThatIsStated) {
  Random random(3);
  double squares = 0, trends = 0;
  for (int run = 0; run < 300; ++run) {
    const FittedValue friction = friction_of(0, random);
    trends += friction.trend / std::sqrt(friction.trend2);
    squares += friction.trend * friction.trend / friction.trend2;
  }
  EXPECT_NEAR(squares / 300, 1, 0.33);
  EXPECT_NEAR(trends / std::sqrt(300), 0, 5);
}

TEST(RegressionFit, TrendHasTheSignOfTheChange) {
  Random random(4);
  for (int run = 0; run < 20; ++run) {
    for (const double rise : {-1.0, 1.0}) {
      const FittedValue friction = friction_of(rise, random);
      EXPECT_GT(rise * friction.trend / std::sqrt(friction.trend2), 2);
    }
  }
}

// At least 95 % of 500 recordings, less four standard deviations of that number. The interval is
// wider by 1.15 for repeated looks, and by its asymmetry; not by much more.
TEST(RegressionFit, IntervalCoversTheTruth) {
  Random random(5);
  int covered = 0;
  double squares = 0;
  for (int run = 0; run < 500; ++run) {
    const FittedValue friction = friction_of(0, random);
    ASSERT_TRUE(friction.is_known());
    const double z = (friction.value - 0.5) / friction.sd;
    covered += std::abs(z) < 1.96 ? 1 : 0;
    squares += z * z;
  }
  EXPECT_GE(covered, 475 - 20);
  EXPECT_GT(squares / 500, 0.35) << "wider than need be";
}

}  // namespace
}  // namespace condyle
