// SPDX-License-Identifier: Apache-2.0
// The driven sensor says what its identification knows, with each estimate.
#include "condyle/estimator/sensors/driven_sensor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/driven_chewing.h"

namespace condyle {
namespace {

using testing_support::DrivenChewing;
using testing_support::DrivenTruth;

constexpr TimeNs kStep_ns = 10'000'000;

Sample sample_of(TimeNs time_ns, const testing_support::DrivenSample& driven) {
  Sample sample;
  sample.time_ns = time_ns;
  sample.kind = SampleKind::one_axis;
  sample.coordinates[0] = driven.position_m;
  sample.drive_N = driven.drive_N;
  sample.drive_valid = true;
  return sample;
}

TEST(DrivenSensor, FindsFrictionAndMassFromItsSamples) {
  RecommendedParameters parameters;
  parameters.impedance.drive.missing_share = parameters.impedance.drive.gain_sd = 0;
  DrivenSensor<double, 1> sensor(parameters, 0, {}, 0);
  const DrivenTruth truth;
  DrivenChewing chewing(truth, 100, 1);
  ImpedanceEstimate<double> impedance;
  for (int i = 0; i < 2000; ++i) {
    impedance = sensor.process(sample_of(i * kStep_ns, chewing.next()), {}).impedance;
  }
  EXPECT_NEAR(impedance.mass_kg.fitted, truth.mass_kg, 0.05 * truth.mass_kg);
  EXPECT_NEAR(impedance.friction_Ns_m.fitted, truth.friction_Ns_m,
              4 * impedance.friction_Ns_m.fitted_sd);
  EXPECT_EQ(impedance.mass_kg.quantity.provenance, Provenance::measured);
}

}  // namespace
}  // namespace condyle
