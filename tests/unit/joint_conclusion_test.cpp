// SPDX-License-Identifier: Apache-2.0
// What is taken for granted of the drive widens what may be said of the point, and is named where
// it is what limits.
#include "condyle/estimator/joint_conclusion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace condyle {
namespace {

using Unknown = JointUnknown;

constexpr double kMass_kg = 0.25, kFriction_Ns_m = 2, kStiffness_N_m = 20, kSliding_N = 0.1;
constexpr double kForce_N = 0.5, kSpeed_m_s = 0.05, kAcceleration_m_s2 = 0.4, kTravel_m = 0.006;

// Of a point that moved for some seconds; what the filter knows has the relative sd `sd`.
JointBelief<double> belief(double sd) {
  JointBelief<double> belief;
  belief.theta.setZero();
  belief.A.setZero();
  const auto is = [&](int i, double value) {
    belief.theta[i] = value / kMass_kg;
    belief.A(i, i) = std::pow(sd * value / kMass_kg, 2);
  };
  is(Unknown::kEta, 1);
  is(Unknown::kLambda, kFriction_Ns_m);
  is(Unknown::kKappa, kStiffness_N_m);
  is(Unknown::kCoulomb, kSliding_N);
  belief.time_s = 7;
  belief.mean_p_m = 0.01;
  belief.mean_p2 = 0.01 * 0.01 + kTravel_m * kTravel_m;
  belief.mean_u2 = kForce_N * kForce_N;
  belief.mean_v2 = kSpeed_m_s * kSpeed_m_s;
  belief.mean_a2 = kAcceleration_m_s2 * kAcceleration_m_s2;
  return belief;
}

// Of a drive that is known in full.
JointParameters perfect() {
  JointParameters parameters;
  parameters.friction_Ns_m = {1, 5};
  parameters.coulomb_N = {0, 1};
  parameters.drive.gain_sd = parameters.drive.delay_sd_s = parameters.drive.missing_share = 0;
  return parameters;
}

JointEstimate<double> conclude(const JointParameters& parameters,
                               const JointBelief<double>& belief) {
  InnovationMoments<double> innovations;
  for (int i = 0; i < 400; ++i) innovations.add(i % 4 < 2 ? 1 : -1);  // white, of variance 1
  return JointConclusion<double>(parameters, innovations).draw(belief);
}

// What a value's interval is wider by than the filter's.
double granted_of(const IdentifiedValue<double>& value) {
  return std::sqrt(value.fitted_sd * value.fitted_sd - value.sampling_sd * value.sampling_sd);
}

// What is missing acts in phase with v, a or p, each value's own.
TEST(JointConclusion, AMissingForceMayBeAnyOfThem) {
  JointParameters parameters = perfect();
  JointBelief<double> without_sliding = belief(0.01);
  without_sliding.theta[Unknown::kCoulomb] = 0;
  EXPECT_NEAR(granted_of(conclude(parameters, without_sliding).friction_Ns_m), 0, 1e-9);
  parameters.drive.missing_share = 0.2;
  const auto estimate = conclude(parameters, without_sliding);
  const double missing_N = 0.2 * kForce_N;
  EXPECT_NEAR(granted_of(estimate.friction_Ns_m), missing_N / kSpeed_m_s, 1e-9);
  EXPECT_NEAR(granted_of(estimate.mass_kg), missing_N / kAcceleration_m_s2, 1e-9);
  EXPECT_NEAR(granted_of(estimate.stiffness_N_m), missing_N / kTravel_m, 1e-9);
  EXPECT_NEAR(granted_of(estimate.offset_N), missing_N, 1e-9);
}

// A drive that is late by tau turns inertia into friction: m w^2 tau.
TEST(JointConclusion, ALateDriveTakesInertiaForFriction) {
  JointParameters parameters = perfect();
  JointBelief<double> free = belief(0.01);
  free.theta[Unknown::kCoulomb] = free.theta[Unknown::kKappa] = 0;
  parameters.drive.delay_sd_s = 1e-4;
  const double w = kAcceleration_m_s2 / kSpeed_m_s;
  const double expected = kMass_kg * w * w * 1e-4;
  EXPECT_NEAR(granted_of(conclude(parameters, free).friction_Ns_m), expected, 0.01 * expected);
}

// Of what widens an interval too much the largest is named, however small they are.
TEST(JointConclusion, NamesWhatLimits) {
  for (const double scale : {1.0, 1e-3, 1e-6}) {
    JointParameters parameters = perfect();
    parameters.friction_resolution_Ns_m = 1e-3 * scale;
    const auto limit = [&](double sd) {
      JointBelief<double> of = belief(sd * scale);
      of.theta[Unknown::kCoulomb] = 0;
      return conclude(parameters, of).friction_Ns_m.limit;
    };
    EXPECT_EQ(limit(1e-5), JointLimit::none);
    EXPECT_EQ(limit(1e-3), JointLimit::resolution);
    parameters.drive.gain_sd = 1e-2 * scale;
    EXPECT_EQ(limit(1e-3), JointLimit::gain);
    parameters.drive.delay_sd_s = 1e-2 * scale;
    EXPECT_EQ(limit(1e-3), JointLimit::delay);
    parameters.drive.missing_share = 1e-1 * scale;
    EXPECT_EQ(limit(1e-3), JointLimit::missing);
  }
  EXPECT_EQ(conclude(perfect(), belief(0.01)).friction_Ns_m.limit, JointLimit::viscous_or_coulomb);
}

}  // namespace
}  // namespace condyle
