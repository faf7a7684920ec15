// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/impedance/mass_spring_damper.h"

#include <Eigen/Dense>
#include <array>
#include <unsupported/Eigen/MatrixFunctions>

#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::number_between;

struct Case {
  double lambda, eta, kappa, c, T, p, v, u0, u1;
};

Case random_case() {
  return {*number_between(-2, 100),
          *number_between(0.5, 20),
          *number_between(-50, 2000),
          *number_between(-2, 2),
          std::pow(10, *number_between(-4, -0.5)),
          *number_between(-0.05, 0.05),
          *number_between(-0.2, 0.2),
          *number_between(-5, 5),
          *number_between(-5, 5)};
}

// The textbook's way: the exponential of the whole linear system, with the drive's value and slope
// and the constant among its states.
Eigen::Vector2d by_exponential(const Case& x) {
  Eigen::Matrix<double, 5, 5> generator = Eigen::Matrix<double, 5, 5>::Zero();
  generator(0, 1) = 1;
  generator.row(1) << -x.kappa, -x.lambda, x.eta, 0, x.c;
  generator(2, 3) = 1;
  Eigen::Matrix<double, 5, 1> state;
  state << x.p, x.v, x.u0, (x.u1 - x.u0) / x.T, 1;
  const Eigen::Matrix<double, 5, 5> scaled = generator * x.T;
  return (scaled.exp() * state).head<2>();
}

template <class Scalar>
DrivenStep<Scalar> step_of(const Case& x) {
  return driven_step<Scalar>({static_cast<Scalar>(x.lambda), static_cast<Scalar>(x.eta),
                              static_cast<Scalar>(x.kappa), static_cast<Scalar>(x.c)},
                             static_cast<Scalar>(x.T), static_cast<Scalar>(x.p),
                             static_cast<Scalar>(x.v), static_cast<Scalar>(x.u0),
                             static_cast<Scalar>(x.u1));
}

// What rounding may add up to: the terms that cancel.
double scale_of(const Case& x) {
  return std::abs(x.p) + std::abs(x.v) +
         x.T * (x.eta * (std::abs(x.u0) + std::abs(x.u1)) + std::abs(x.c));
}

RC_GTEST_PROP(MassSpringDamper, StepIsTheExponential, ()) {
  const Case x = random_case();
  const Eigen::Vector2d expected = by_exponential(x);
  const auto step = step_of<double>(x);
  const double growth = std::exp(std::max(0.0, -2 * x.lambda) * x.T + 10 * x.T);
  RC_ASSERT(std::abs(step.position[kSolution] - expected[0]) < 1e-12 * growth * scale_of(x));
  RC_ASSERT(std::abs(step.velocity[kSolution] - expected[1]) <
            1e-12 * growth * scale_of(x) * (1 + std::sqrt(std::abs(x.kappa))));
  const auto single = step_of<float>(x);
  RC_ASSERT(std::abs(static_cast<double>(single.position[kSolution]) - expected[0]) <
            1e-5 * growth * scale_of(x));
}

// Against central differences of the exponential.
RC_GTEST_PROP(MassSpringDamper, SensitivitiesAreItsDerivatives, ()) {
  const Case x = random_case();
  const auto step = step_of<double>(x);
  const std::array<std::pair<int, double Case::*>, 8> columns = {{{kOfPosition, &Case::p},
                                                                  {kOfVelocity, &Case::v},
                                                                  {kOfDriveBefore, &Case::u0},
                                                                  {kOfDrive, &Case::u1},
                                                                  {kOfLambda, &Case::lambda},
                                                                  {kOfEta, &Case::eta},
                                                                  {kOfKappa, &Case::kappa},
                                                                  {kOfOffset, &Case::c}}};
  for (const auto& [column, member] : columns) {
    const double h = 1e-4 * std::max(1.0, std::abs(x.*member));
    Case above = x, below = x;
    above.*member += h;
    below.*member -= h;
    const Eigen::Vector2d slope = (by_exponential(above) - by_exponential(below)) / (2 * h);
    const double tolerance = 1e-5 * (scale_of(x) + slope.norm());
    RC_ASSERT(std::abs(step.position[column] - slope[0]) < tolerance);
    RC_ASSERT(std::abs(step.velocity[column] - slope[1]) < tolerance * 50);
  }
}

// The derivatives of the responses, likewise: each response is the exponential of one unit.
RC_GTEST_PROP(MassSpringDamper, ResponsesHaveTheirDerivatives, ()) {
  Case x = random_case();
  x.eta = 1;
  x.c = x.p = x.v = x.u0 = x.u1 = 0;
  const auto response = driven_response<double>({x.lambda, x.eta, x.kappa, x.c}, x.T);
  constexpr std::array<double Case::*, kDrivenCauses> causes = {&Case::p, &Case::v, &Case::u0,
                                                                &Case::u1};
  for (int cause = 0; cause < kDrivenCauses; ++cause) {
    Case one = x;
    one.*causes[static_cast<std::size_t>(cause)] = 1;
    const Eigen::Vector2d expected = by_exponential(one);
    const auto slope = [&one](double Case::*member) {
      const double h = 1e-4 * std::max(1.0, std::abs(one.*member));
      Case above = one, below = one;
      above.*member += h;
      below.*member -= h;
      return Eigen::Vector2d((by_exponential(above) - by_exponential(below)) / (2 * h));
    };
    const Eigen::Vector2d of_lambda = slope(&Case::lambda), of_kappa = slope(&Case::kappa);
    for (int row = 0; row < 2; ++row) {
      const double scale = 1e-5 * (1 + expected.norm());
      RC_ASSERT(std::abs(response.value(row, cause) - expected[row]) < scale * 1e-3);
      RC_ASSERT(std::abs(response.of_lambda(row, cause) - of_lambda[row]) < scale);
      RC_ASSERT(std::abs(response.of_kappa(row, cause) - of_kappa[row]) < scale);
    }
  }
}

RC_GTEST_PROP(MassSpringDamper, TwoStepsAreOne, ()) {
  const Case x = random_case();
  const double share = *number_between(0.01, 0.99), between = x.u0 + share * (x.u1 - x.u0);
  Case first = x, second = x;
  first.T = share * x.T;
  first.u1 = between;
  const auto half = step_of<double>(first);
  second.T = x.T - first.T;
  second.u0 = between;
  second.p = half.position[kSolution];
  second.v = half.velocity[kSolution];
  const auto whole = step_of<double>(x), parts = step_of<double>(second);
  const double tolerance = 1e-11 * scale_of(x) * std::exp(12 * x.T);
  RC_ASSERT(std::abs(whole.position[kSolution] - parts.position[kSolution]) < tolerance);
}

// Rates a diverging filter might come to: a number or none, no endless loop.
TEST(MassSpringDamper, EndsForAnyRates) {
  for (const double rate : {0.0, 1e9, -1e9, 1e300, std::nan("")}) {
    const auto step = driven_step<double>({rate, 4, rate, 0}, 0.02, 0.01, 0.1, 1, 2);
    EXPECT_TRUE(rate != 0.0 || std::isfinite(step.position[kSolution]));
  }
}

}  // namespace
}  // namespace condyle
