// SPDX-License-Identifier: Apache-2.0
// What is stated about drive and mass, against what the recording shows; and what the regression
// says of its own samples.
#include <gtest/gtest.h>

#include <cmath>

#include "condyle/estimator/impedance/point_identification.h"
#include "support/random.h"
#include "unit/estimator/chewing_point.h"

namespace condyle {
namespace {

using testing_support::ChewingPoint;
using testing_support::exact;
using testing_support::identify;
using testing_support::kAsItIs;

// All forces times `gain`, as a drive's calibration multiplies them.
ChewingPoint scaled(double mass_kg, double gain) {
  return {.mass_kg = gain * mass_kg,
          .friction_Ns_m = gain * 0.05,
          .stiffness_N_m = gain * 20,
          .offset_N = gain * 0.1};
}

// A gain within twice its standard deviation contradicts no stated mass, one beyond six of them
// does: for light and heavy points.
TEST(PointStatement, AKnownMassIsContradictedByGainsBeyondTheStatedOnly) {
  for (const double mass_kg : {0.1, 0.25, 2.0}) {
    for (const double gain_sd : {0.05, 0.1}) {
      ImpedanceParameters parameters = exact();
      parameters.mass = MassModel::known;
      parameters.mass_kg = {mass_kg, 1e-3 * mass_kg};
      parameters.drive.gain_sd = gain_sd;
      for (const double sds : {-2.0, 0.0, 2.0, 6.0}) {
        const auto estimate =
            identify<double>(parameters, scaled(mass_kg, 1 + sds * gain_sd), 15, kAsItIs)
                ->estimate();
        EXPECT_EQ(estimate.friction_Ns_m.limit == ImpedanceLimit::mass_stated, sds > 3)
            << mass_kg << " kg, " << sds << " of " << gain_sd << ": "
            << limit_name(estimate.friction_Ns_m.limit);
      }
    }
  }
}

TEST(PointStatement, ConcludesOnceASecond) {
  for (const int rate_Hz : {50, 100, 125}) {
    PointIdentification<double> identification(exact());
    const std::uint64_t before = identification.conclusions();
    for (int k = 0; k <= 20 * rate_Hz; ++k) {
      identification.add_position(k * (kNanosecondsPerSecond / rate_Hz),
                                  ChewingPoint::position_m(k / static_cast<double>(rate_Hz)));
    }
    EXPECT_EQ(identification.conclusions() - before, 21U) << rate_Hz;
  }
}

TEST(PointStatement, CountsNoProblemInACleanRecording) {
  const DriveCounts counts = identify<double>(exact(), {}, 10, kAsItIs)->counts();
  EXPECT_EQ(counts.drive_not_in_order, 0U);
  EXPECT_EQ(counts.drive_gaps, 0U);
  EXPECT_EQ(counts.positions_too_early, 0U);
  EXPECT_EQ(counts.positions_in_contact, 0U);
  EXPECT_EQ(counts.positions_dropped, 0U);
}

// However exact the positions are, the kernel is not narrower than the samples allow.
TEST(PointRegression, KernelSpansSixSamplesToEachSide) {
  for (const double rate_Hz : {60.0, 100.0, 400.0}) {
    for (const double noise_m : {0.0, 1e-9, 1e-6, 1e-3}) {
      PointRegression<double> regression(exact());
      testing_support::Random random(1);
      for (int k = 0; k < 5 * rate_Hz; ++k) {
        const TimeNs time_ns = nanoseconds(k / rate_Hz);
        regression.add_drive(time_ns, 0.01 * random.normal());
        regression.add_position(time_ns, noise_m * random.normal());
      }
      ASSERT_TRUE(regression.has_begun());
      const double half_width_s =
          std::sqrt(ModulatingKernel<double>::kInverseVariance) / regression.setup().cutoff_rad_s;
      EXPECT_GT(half_width_s * rate_Hz, 6) << rate_Hz << " Hz, " << noise_m;
    }
  }
}

// The effect of the samples' white noise is the sum over the kernel, at the step that they have in
// the mean: not at that of the first ones, if the clock runs differently then.
TEST(PointRegression, NoiseGainsAreThoseOfTheMeanStep) {
  for (const double drift : {-0.015, 0.0, 0.015}) {
    PointRegression<double> regression(exact());
    testing_support::Random random(1);
    constexpr double kFirst_s = 0.01;
    const double step_s = kFirst_s * (1 + drift);
    const auto time_of = [&](int k) {
      return nanoseconds(k < 17 ? k * kFirst_s : 16 * kFirst_s + (k - 16) * step_s);
    };
    for (int k = 0; k < 3000; ++k) {
      regression.add_drive(time_of(k), 0.01 * random.normal());
      regression.add_position(time_of(k), 1e-5 * random.normal());
    }
    ASSERT_TRUE(regression.has_begun());
    const RegressionSetup setup = regression.setup();
    const ModulatingKernel<double> kernel(std::sqrt(ModulatingKernel<double>::kInverseVariance) /
                                          setup.cutoff_rad_s);
    KernelGains expected;
    for (int k = -1000; k <= 1000; ++k) {
      const KernelWeights<double> phi = kernel.at(k * step_s);
      expected.G0 += step_s * step_s * phi.value * phi.value;
      expected.G2 += step_s * step_s * phi.slope * phi.slope;
      expected.G4 += step_s * step_s * phi.curvature * phi.curvature;
    }
    for (const KernelGains& gains : {setup.position, setup.drive}) {
      EXPECT_NEAR(gains.G0 / expected.G0, 1, 2e-3) << drift;
      EXPECT_NEAR(gains.G2 / expected.G2, 1, 2e-3) << drift;
      EXPECT_NEAR(gains.G4 / expected.G4, 1, 2e-3) << drift;
    }
  }
}

}  // namespace
}  // namespace condyle
