// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/observability.h"

#include <Eigen/LU>

#include "unit/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::number_between;
using Point = OperatingPoint<double>;

Point random_point() {
  return {*number_between(-0.02, 0.02), *number_between(-0.2, 0.2), *number_between(0.01, 2),
          *number_between(0.1, 0.6),    *number_between(-2, 2),     *number_between(-20, 20)};
}

bool is_close(double actual, double expected, double scale) {
  return std::abs(actual - expected) <= 1e-10 * (scale + std::abs(expected));
}

template <class Matrix>
int rank_of(const Matrix& matrix) {
  return judge_observability(matrix).rank;
}

// p, v, kv and m together: the block that decides rank has determinant (v u' - a u) / m^3.
RC_GTEST_PROP(Observability, FullSystemHasTheClosedFormDeterminant, ()) {
  const Point at = random_point();
  const double v = at.velocity_m_s, m = at.mass_kg, a = at.acceleration_m_s2();
  const Eigen::Matrix4d O = observability_matrix<FullSystem>(at);
  const Eigen::Matrix2d block = O.bottomRightCorner<2, 2>();
  const double scale = std::abs(block(0, 0) * block(1, 1)) + std::abs(block(0, 1) * block(1, 0));
  const double closed = (v * at.force_rate_N_s - a * at.force_N) / (m * m * m);
  RC_ASSERT(is_close(block.determinant(), closed, scale));
  // The same in terms of the jerk j: (v j - a^2) / m^2.
  const double j = (at.force_rate_N_s - at.friction_Ns_m * a) / m;
  RC_ASSERT(is_close((v * j - a * a) / (m * m), closed, scale));
}

RC_GTEST_PROP(Observability, EntriesAreTheCorrectedEquations, ()) {
  const Point at = random_point();
  const double v = at.velocity_m_s, m = at.mass_kg, kv = at.friction_Ns_m, u = at.force_N;
  const double a = at.acceleration_m_s2(), u_rate = at.force_rate_N_s;
  const auto stage_1 = observability_matrix<MotionSystem>(at);
  RC_ASSERT(stage_1 == Eigen::Matrix3d(Eigen::Vector3d(1, 1, 1 / m).asDiagonal()));
  const auto stage_2 = observability_matrix<FrictionSystem>(at);
  RC_ASSERT(is_close(stage_2(3, 2), -v / m, 0));                      // (38)
  RC_ASSERT(is_close(stage_2(5, 2), (2 * kv * v - u) / (m * m), 1));  // (39)
  const auto stage_3 = observability_matrix<MassSystem>(at);
  RC_ASSERT(is_close(stage_3(3, 2), -a / m, 0));
  RC_ASSERT(is_close(stage_3(5, 2), 2 * kv * a / (m * m) - u_rate / (m * m), 100));  // (43)
  const auto full = observability_matrix<FullSystem>(at);
  RC_ASSERT(full.row(1) == Eigen::RowVector4d(0, 1, 0, 0));  // (29)
}

RC_GTEST_PROP(Observability, PrintedMatricesDifferOnlyWhereThePaperErrs, ()) {
  const Point at = random_point();
  const auto count_differences = [](const auto& a, const auto& b) {
    return (a.array() != b.array()).count();
  };
  RC_ASSERT(count_differences(printed_friction_matrix(at),
                              observability_matrix<FrictionSystem>(at)) == 3);
  RC_ASSERT(is_close(printed_friction_matrix(at)(3, 2), at.force_N / at.mass_kg, 0));
  RC_ASSERT(count_differences(printed_mass_matrix(at), observability_matrix<MassSystem>(at)) == 1);
}

RC_GTEST_PROP(Observability, UnknownDriveIsNeverObservable, ()) {
  const Point at = random_point();
  RC_ASSERT(rank_of(observability_matrix<UnknownDriveSystem>(at)) <= 5);
  RC_ASSERT(rank_of(observability_matrix<PrintedFullSystem>(at)) <= 3);
}

TEST(Observability, StageTwoNeedsVelocityOrForce) {
  for (const double v : {0.0, 0.05}) {
    for (const double u : {0.0, 0.3}) {
      Point at;
      at.velocity_m_s = v;
      at.force_N = u;
      EXPECT_EQ(rank_of(observability_matrix<FrictionSystem>(at)), v != 0 || u != 0 ? 3 : 2);
    }
  }
}

TEST(Observability, StageThreeNeedsAccelerationOrForceRate) {
  for (const double a : {0.0, 1.2}) {
    for (const double u_rate : {0.0, 1.0}) {
      Point at;
      at.friction_Ns_m = 0.5;
      at.velocity_m_s = 0.0625;
      at.mass_kg = 0.25;
      at.force_N = at.friction_Ns_m * at.velocity_m_s + at.mass_kg * a;
      at.force_rate_N_s = u_rate;
      EXPECT_EQ(rank_of(observability_matrix<MassSystem>(at)), a != 0 || u_rate != 0 ? 3 : 2)
          << a << " " << u_rate;
    }
  }
}

TEST(Observability, FullSystemNeedsADriveThatIsNotProportionalToVelocity) {
  Point at;
  EXPECT_EQ(rank_of(observability_matrix<FullSystem>(at)), 4);
  at.force_rate_N_s = at.acceleration_m_s2() * at.force_N / at.velocity_m_s;
  EXPECT_EQ(rank_of(observability_matrix<FullSystem>(at)), 3);
}

TEST(Observability, FiguresOfAKnownMatrix) {
  Eigen::Matrix3d matrix = Eigen::Vector3d(4, 2, 0.5).asDiagonal();
  const auto result = judge_observability(matrix);
  EXPECT_EQ(result.rank, 3);
  EXPECT_DOUBLE_EQ(result.smallest_singular_value, 0.5);
  EXPECT_DOUBLE_EQ(result.condition_number, 8);
  matrix(2, 2) = 0;
  EXPECT_EQ(judge_observability(matrix).rank, 2);
  EXPECT_EQ(judge_observability(matrix).smallest_singular_value, 0);
}

}  // namespace
}  // namespace condyle
