// SPDX-License-Identifier: Apache-2.0
#include "observability/observability.h"

#include <Eigen/LU>

#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::number_between;
using Point = OperatingPoint<double>;

template <template <class> class System>
auto matrix_at(const Point& at) {
  return observability_matrix<System>(at).O;
}

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
  const Eigen::Matrix4d O = matrix_at<FullSystem>(at);
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
  const auto stage_1 = matrix_at<MotionSystem>(at);
  RC_ASSERT(stage_1 == Eigen::Matrix3d(Eigen::Vector3d(1, 1, 1 / m).asDiagonal()));
  const auto stage_2 = matrix_at<FrictionSystem>(at);
  RC_ASSERT(is_close(stage_2(3, 2), -v / m, 0));                      // (38)
  RC_ASSERT(is_close(stage_2(5, 2), (2 * kv * v - u) / (m * m), 1));  // (39)
  const auto stage_3 = matrix_at<MassSystem>(at);
  RC_ASSERT(is_close(stage_3(3, 2), -a / m, 0));
  RC_ASSERT(is_close(stage_3(5, 2), 2 * kv * a / (m * m) - u_rate / (m * m), 100));  // (43)
  const auto full = matrix_at<FullSystem>(at);
  RC_ASSERT(full.row(1) == Eigen::RowVector4d(0, 1, 0, 0));  // (29)
}

RC_GTEST_PROP(Observability, PrintedMatricesDifferOnlyWhereThePaperErrs, ()) {
  const Point at = random_point();
  const auto count_differences = [](const auto& a, const auto& b) {
    return (a.O.array() != b.O.array()).count();
  };
  RC_ASSERT(count_differences(printed_friction_matrix(at),
                              observability_matrix<FrictionSystem>(at)) == 3);
  RC_ASSERT(is_close(printed_friction_matrix(at).O(3, 2), at.force_N / at.mass_kg, 0));
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

// At states whose acceleration and determinant are zero only up to rounding, too.
RC_GTEST_PROP(Observability, StageThreeNeedsAccelerationOrForceRate, ()) {
  Point at = random_point();
  at.force_N = at.friction_Ns_m * at.velocity_m_s;  // a is zero or a rounding error
  at.force_rate_N_s = 0;
  RC_PRE(std::abs(at.velocity_m_s) > 1e-3);
  RC_ASSERT(rank_of(observability_matrix<MassSystem>(at)) == 2);
  RC_ASSERT(rank_of(observability_matrix<FullSystem>(at)) <= 3);
  at.force_rate_N_s = *number_between(0.1, 20);
  RC_ASSERT(rank_of(observability_matrix<MassSystem>(at)) == 3);
  at.force_rate_N_s = 0;
  at.force_N += *number_between(0.01, 2);
  RC_ASSERT(rank_of(observability_matrix<MassSystem>(at)) == 3);
}

RC_GTEST_PROP(Observability, FullSystemNeedsADriveThatIsNotProportionalToVelocity, ()) {
  Point at = random_point();
  RC_PRE(std::abs(at.velocity_m_s) > 1e-3);
  at.force_rate_N_s = at.acceleration_m_s2() * at.force_N / at.velocity_m_s;
  RC_ASSERT(rank_of(observability_matrix<FullSystem>(at)) <= 3);
  at.force_rate_N_s += *number_between(1, 20);
  RC_ASSERT(rank_of(observability_matrix<FullSystem>(at)) == 4);
}

// Of two columns that differ by rounding, or by more; the second is what is left of terms a
// thousand times as large. The unit of a state scales its column.
TEST(Observability, RoundingCountsInAnyUnit) {
  for (const double unit : {1e-9, 1.0, 1e9}) {
    for (const double difference : {1e-13, 1e-9}) {
      ObservabilityMatrix<double, 2, 2> matrix;
      matrix.O << 1, unit, 1, unit * (1 + difference);
      matrix.term_size << 1, 1000 * unit, 1, 1000 * unit;
      EXPECT_EQ(judge_observability(matrix).rank, difference > 1e-10 ? 2 : 1)
          << unit << ' ' << difference;
    }
  }
}

TEST(Observability, FiguresOfAKnownMatrix) {
  ObservabilityMatrix<double, 3, 3> matrix;
  matrix.O = Eigen::Vector3d(4, 2, 0.5).asDiagonal();
  matrix.term_size = matrix.O;
  const auto result = judge_observability(matrix);
  EXPECT_EQ(result.rank, 3);
  EXPECT_DOUBLE_EQ(result.smallest_singular_value, 0.5);
  EXPECT_DOUBLE_EQ(result.condition_number, 8);
  matrix.O(2, 2) = 1e-16;  // what is left of terms of size 1
  matrix.term_size(2, 2) = 1;
  EXPECT_EQ(judge_observability(matrix).rank, 2);
  EXPECT_EQ(judge_observability(matrix).smallest_singular_value, 0);
  matrix.O(2, 2) = std::nan("");
  EXPECT_EQ(judge_observability(matrix).rank, -1);
}

}  // namespace
}  // namespace condyle
