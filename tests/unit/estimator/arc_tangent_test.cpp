// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/math/arc_tangent.h"

#include <cmath>

#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::number_between;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Error of atan2(y, x) in ulp of the result.
template <class Scalar>
double error_ulp(Scalar y, Scalar x) {
  const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
  const auto rounded = std::abs(static_cast<Scalar>(exact));
  const Scalar ulp = std::nextafter(rounded, std::numeric_limits<Scalar>::infinity()) - rounded;
  const long double error = static_cast<long double>(elementary::atan2(y, x)) - exact;
  return static_cast<double>(std::abs(error) / static_cast<long double>(ulp));
}

RC_GTEST_PROP(ArcTangent, IsWithinTheStatedError, ()) {
  for (int i = 0; i < 50; ++i) {
    const double size = std::pow(10, *number_between(-12, 3));
    const double y = size * *number_between(-1, 1), x = *number_between(-1, 1);
    RC_ASSERT(error_ulp(y, x) <= 3);
    RC_ASSERT(error_ulp(x, y) <= 3);
    RC_ASSERT(error_ulp(static_cast<float>(y), static_cast<float>(x)) <= 0.51);
  }
}

TEST(ArcTangent, HoldsOnTheAxesAndDiagonals) {
  const double pi = std::acos(-1.0);
  EXPECT_EQ(elementary::atan2(0.0, 0.0), 0);
  EXPECT_EQ(elementary::atan2(0.0, 2.0), 0);
  EXPECT_EQ(elementary::atan2(2.0, 0.0), pi / 2);
  EXPECT_EQ(elementary::atan2(-2.0, 0.0), -pi / 2);
  EXPECT_EQ(elementary::atan2(0.0, -2.0), pi);
  EXPECT_EQ(elementary::atan2(3.0, 3.0), pi / 4);
  EXPECT_EQ(elementary::atan2(3.0, -3.0), 3 * pi / 4);
  EXPECT_EQ(elementary::atan2(1e-300, 1.0), 1e-300);
  EXPECT_EQ(elementary::atan2(1e300, 1e300), pi / 4);
  EXPECT_TRUE(std::isnan(elementary::atan2(kNaN, 1.0)));
  EXPECT_TRUE(std::isnan(elementary::atan2(1.0, kNaN)));
  EXPECT_TRUE(std::isnan(elementary::atan2(1.0, std::numeric_limits<double>::infinity())));
}

static_assert(elementary::atan2(1.0, 1.0) > 0.785 && elementary::atan2(1.0, 1.0) < 0.786);

}  // namespace
}  // namespace condyle
