// SPDX-License-Identifier: Apache-2.0
// The kernel gives value, slope and curvature of smooth signals, and its gains those of noise.
#include "condyle/estimator/math/modulating_kernel.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

namespace condyle {
namespace {

struct Smooth {
  double value = 0, slope = 0, curvature = 0;
};

// Sums of the kernel at `center_s` over samples of `signal`, `step_s` apart.
template <class Signal>
Smooth smooth(const ModulatingKernel<double>& kernel, double center_s, double step_s,
              const Signal& signal) {
  Smooth sums;
  const int reach = static_cast<int>(kernel.half_width_s() / step_s) + 2;
  const int middle = static_cast<int>(center_s / step_s);
  for (int k = middle - reach; k <= middle + reach; ++k) {
    const auto phi = kernel.at(center_s - k * step_s);
    sums.value += step_s * phi.value * signal(k * step_s);
    sums.slope += step_s * phi.slope * signal(k * step_s);
    sums.curvature += step_s * phi.curvature * signal(k * step_s);
  }
  return sums;
}

TEST(ModulatingKernel, GivesTheDerivativesOfAParabola) {
  EXPECT_TRUE(rc::check("at any place between samples", [] {
    const double half_width_s = *rc::gen::inRange(60, 300) * 1e-3;
    const double step_s = half_width_s / *rc::gen::inRange(7, 40);
    const double center_s = *rc::gen::inRange(0, 1000) * 1e-3;
    const Smooth sums = smooth(ModulatingKernel<double>(half_width_s), center_s, step_s,
                               [](double t) { return 1 - 2 * t + 3 * t * t; });
    const double spread = half_width_s * half_width_s / ModulatingKernel<double>::kInverseVariance;
    const double expected = 1 - 2 * center_s + 3 * (center_s * center_s + spread);
    RC_ASSERT(std::abs(sums.value - expected) < 1e-3);
    RC_ASSERT(std::abs(sums.slope - (-2 + 6 * center_s)) < 1e-2);
    RC_ASSERT(std::abs(sums.curvature - 6) < 0.2);
  }));
}

TEST(ModulatingKernel, EndsAtItsHalfWidth) {
  const ModulatingKernel<double> kernel(0.1);
  for (const double t : {-0.2, -0.1, 0.1, 0.5, std::nan("")}) {
    EXPECT_EQ(kernel.at(t).value, 0);
    EXPECT_EQ(kernel.at(t).slope, 0);
    EXPECT_EQ(kernel.at(t).curvature, 0);
  }
  EXPECT_GT(kernel.at(0.09).value, 0);
}

TEST(ModulatingKernel, SlopeAndCurvatureAreItsDerivatives) {
  const ModulatingKernel<double> kernel(0.13);
  constexpr double kStep = 1e-6;
  for (double t = -0.125; t < 0.125; t += 0.01) {
    const auto before = kernel.at(t - kStep), after = kernel.at(t + kStep), here = kernel.at(t);
    EXPECT_NEAR((after.value - before.value) / (2 * kStep), here.slope, 1e-4);
    EXPECT_NEAR((after.slope - before.slope) / (2 * kStep), here.curvature, 1e-2);
  }
}

TEST(ModulatingKernel, GainsAreTheIntegralsOfItsSquares) {
  const ModulatingKernel<double> kernel(0.2);
  double value2 = 0, slope2 = 0, curvature2 = 0;
  constexpr double kStep = 1e-5;
  for (double t = -0.2; t < 0.2; t += kStep) {
    const auto phi = kernel.at(t);
    value2 += kStep * phi.value * phi.value;
    slope2 += kStep * phi.slope * phi.slope;
    curvature2 += kStep * phi.curvature * phi.curvature;
  }
  const double step_s = 1.0 / 60;
  const KernelGains gains = kernel.gains(step_s);
  EXPECT_NEAR(gains.G0 / (step_s * value2), 1, 1e-4);
  EXPECT_NEAR(gains.G2 / (step_s * slope2), 1, 1e-4);
  EXPECT_NEAR(gains.G4 / (step_s * curvature2), 1, 1e-3);
}

}  // namespace
}  // namespace condyle
