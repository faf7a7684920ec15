// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/release/release_motion.h"

#include <Eigen/Dense>
#include <vector>

#include "condyle/estimator/impedance/mass_spring_damper.h"
#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::number_between;

// All regimes, critical damping included: the damping ratio is near 1 in a third of the cases.
ReleaseRates<double> random_rates() {
  const double omega = *number_between(2, 60);
  const int regime = *rc::gen::inRange(0, 3);
  const double zeta = regime == 0   ? *number_between(-0.02, 1)
                      : regime == 1 ? *number_between(0.999, 1.001)
                                    : *number_between(1, 8);
  return {2 * zeta * omega, omega * omega};
}

// Against the series of mass_spring_damper.h, which shares no formula with it.
RC_GTEST_PROP(ReleaseMotion, ResponseIsTheDrivenPointsWithoutDrive, ()) {
  const auto rates = random_rates();
  const double t = *number_between(0, 1);
  const auto expected = driven_response<double>({rates.lambda, 0, rates.kappa, 0}, t);
  const auto actual = release_response(rates, t);
  const auto is_near = [](double a, double b, double scale) {
    return std::abs(a - b) < 1e-9 * scale;
  };
  RC_ASSERT(is_near(actual.C, expected.value(0, kFromPosition), 1));
  RC_ASSERT(is_near(actual.S, expected.value(0, kFromVelocity), 1));
  RC_ASSERT(is_near(actual.C_of_lambda, expected.of_lambda(0, kFromPosition), 1));
  RC_ASSERT(is_near(actual.S_of_lambda, expected.of_lambda(0, kFromVelocity), 1));
  RC_ASSERT(is_near(actual.C_of_kappa, expected.of_kappa(0, kFromPosition), 1));
  RC_ASSERT(is_near(actual.S_of_kappa, expected.of_kappa(0, kFromVelocity), 1));
}

RC_GTEST_PROP(ReleaseMotion, SensitivitiesAreDifferences, ()) {
  const auto rates = random_rates();
  const double t = *number_between(0, 1);
  const auto at = release_response(rates, t);
  const double h = 1e-5 * (1 + std::abs(rates.lambda)), k = 1e-5 * rates.kappa;
  const auto above = release_response<double>({rates.lambda + h, rates.kappa}, t);
  const auto below = release_response<double>({rates.lambda - h, rates.kappa}, t);
  const auto stiffer = release_response<double>({rates.lambda, rates.kappa + k}, t);
  const auto softer = release_response<double>({rates.lambda, rates.kappa - k}, t);
  RC_ASSERT(std::abs(at.C_of_lambda - (above.C - below.C) / (2 * h)) < 1e-7);
  RC_ASSERT(std::abs(at.S_of_lambda - (above.S - below.S) / (2 * h)) < 1e-7);
  RC_ASSERT(std::abs(at.C_of_kappa - (stiffer.C - softer.C) / (2 * k)) < 1e-7);
  RC_ASSERT(std::abs(at.S_of_kappa - (stiffer.S - softer.S) / (2 * k)) < 1e-7);
}

RC_GTEST_PROP(ReleaseMotion, FloatIsAsGoodAsItCan, ()) {
  const auto rates = random_rates();
  const double t = *number_between(0, 1);
  const auto expected = release_response(rates, t);
  const auto actual = release_response<float>(
      {static_cast<float>(rates.lambda), static_cast<float>(rates.kappa)}, static_cast<float>(t));
  RC_ASSERT(std::abs(static_cast<double>(actual.C) - expected.C) < 2e-3);
}

// The bound against the textbook's: the inverse of J'J from a dense Jacobian.
TEST(ReleaseMotion, BoundIsTheInverseOfTheInformation) {
  const ReleaseRates<double> rates{40, 400};
  std::vector<double> times;
  for (int i = 0; i <= 36; ++i) times.push_back(3 + i / 60.0);
  constexpr double kOpening_m = 0.01, kVelocity_m_s = 0.05, kNoise_m = 5e-5;
  for (const bool starts_at_rest : {false, true}) {
    Eigen::Matrix<double, Eigen::Dynamic, 5> J(times.size(), 5);
    for (std::size_t i = 0; i < times.size(); ++i) {
      const auto at = release_response(rates, times[i] - times[0]);
      J.row(static_cast<Eigen::Index>(i))
          << kOpening_m * at.C_of_lambda + kVelocity_m_s * at.S_of_lambda,
          kOpening_m * at.C_of_kappa + kVelocity_m_s * at.S_of_kappa, 1 - at.C, at.C, at.S;
    }
    const int unknowns = starts_at_rest ? 4 : 5;
    const Eigen::MatrixXd used = J.leftCols(unknowns);
    const Eigen::MatrixXd expected = kNoise_m * kNoise_m * (used.transpose() * used).inverse();
    const auto bound =
        release_bound<double>(times, rates, kOpening_m, kVelocity_m_s, kNoise_m, starts_at_rest);
    for (int i = 0; i < unknowns; ++i) {
      for (int j = 0; j < unknowns; ++j) {
        const double scale = std::sqrt(expected(i, i) * expected(j, j));
        EXPECT_NEAR(bound(i, j), expected(i, j), 1e-6 * scale) << i << ' ' << j;
      }
    }
  }
}

// The delta method with numerical gradients.
RC_GTEST_PROP(ReleaseMotion, DeviationsFollowFromTheCovariance, ()) {
  const double omega = *number_between(2, 60);
  const ReleaseRates<double> rates{2 * *number_between(0, 3) * omega, omega * omega};
  const double of_lambda = *number_between(0.01, 10), of_kappa = *number_between(0.01, 10) * omega;
  const double correlation = *number_between(-0.99, 0.99);
  ReleaseCovariance<double> covariance = ReleaseCovariance<double>::Zero();
  covariance(kReleaseLambda, kReleaseLambda) = of_lambda * of_lambda;
  covariance(kReleaseKappa, kReleaseKappa) = of_kappa * of_kappa;
  covariance(kReleaseLambda, kReleaseKappa) = covariance(kReleaseKappa, kReleaseLambda) =
      correlation * of_lambda * of_kappa;
  const auto deviation_of = [&](auto&& value) {
    const double h = 1e-5 * omega, k = 1e-5 * rates.kappa;
    const Eigen::Vector2d gradient(
        (value(rates.lambda + h, rates.kappa) - value(rates.lambda - h, rates.kappa)) / (2 * h),
        (value(rates.lambda, rates.kappa + k) - value(rates.lambda, rates.kappa - k)) / (2 * k));
    return std::sqrt(gradient.dot(covariance.topLeftCorner<2, 2>() * gradient));
  };
  const auto is_near = [](double a, double b) { return std::abs(a / b - 1) < 1e-5; };
  const auto actual = release_deviations(covariance, rates);
  RC_ASSERT(is_near(actual.damping_rate_per_s, of_lambda));
  RC_ASSERT(is_near(actual.stiffness_per_mass_per_s2, of_kappa));
  RC_ASSERT(is_near(actual.damping_ratio,
                    deviation_of([](double l, double k) { return l / (2 * std::sqrt(k)); })));
  RC_ASSERT(is_near(actual.natural_frequency_rad_s,
                    deviation_of([](double, double k) { return std::sqrt(k); })));
}

// What the design names for 0.6 s at 60 Hz and 0.05 mm; it takes an opening of 10 mm.
TEST(ReleaseMotion, BoundOfTheNamedReleases) {
  std::vector<double> times;
  for (int i = 0; i <= 36; ++i) times.push_back(i / 60.0);
  const auto bound_per_s = [&](double lambda) {
    const auto bound = release_bound<double>(times, {lambda, 400}, 0.01, 0, 5e-5, false);
    return release_deviations<double>(bound, {lambda, 400}).damping_rate_per_s;
  };
  EXPECT_NEAR(bound_per_s(8), 0.042, 0.001);
  EXPECT_NEAR(bound_per_s(40), 1.63, 0.01);
  EXPECT_NEAR(bound_per_s(80), 18.3, 0.1);
}

}  // namespace
}  // namespace condyle
