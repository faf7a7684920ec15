// SPDX-License-Identifier: Apache-2.0
// What the identification of the joint takes friction, mass, stiffness and offset for before it has
// seen anything. How well it finds them: consistency/joint_identification_test.cpp.
#include "condyle/estimator/joint_identification.h"

#include <gtest/gtest.h>

#include <cmath>

namespace condyle {
namespace {

// In the order of the state.
constexpr int kLambda = 4, kEta = 5, kKappa = 6, kC = 8, kGamma = 9;

// Friction, stiffness, offset and Coulomb friction are the mass's inverse eta times what is
// independent of it: var(k eta) = E[eta^2] var k + k^2 var eta, cov(k eta, l eta) = k l var eta.
TEST(JointIdentification, BeginsWithThePriors) {
  JointParameters parameters;
  parameters.friction_Ns_m = {2, 0.5};
  parameters.mass_kg = {0.5, 0.2};
  parameters.stiffness_N_m = {100, 40};
  parameters.offset_N = {3, 1};
  parameters.coulomb_N = {0.4, 0.3};
  const JointIdentification<double> stage(parameters);
  const auto& A = stage.covariance();
  const double eta = 1 / 0.5, eta_variance = A(kEta, kEta);
  // That of 1 / m to the first order, and a little more.
  EXPECT_GT(eta_variance, std::pow(eta * eta * 0.2, 2));
  EXPECT_LT(eta_variance, 1.5 * std::pow(eta * eta * 0.2, 2));

  struct Unknown {
    int state;
    double mean, sd;
  };
  const Unknown unknowns[] = {{kLambda, 2, 0.5}, {kKappa, 100, 40}, {kC, 3, 1}, {kGamma, 0.4, 0.3}};
  for (const Unknown& k : unknowns) {
    const double variance =
        (eta * eta + eta_variance) * k.sd * k.sd + k.mean * k.mean * eta_variance;
    EXPECT_NEAR(A(k.state, k.state), variance, 1e-12 * variance);
    EXPECT_NEAR(A(k.state, kEta), k.mean * eta_variance, 1e-12 * k.mean);
    for (const Unknown& l : unknowns) {
      if (l.state == k.state) continue;
      EXPECT_NEAR(A(k.state, l.state), k.mean * l.mean * eta_variance, 1e-12 * k.mean * l.mean);
    }
  }
  const auto estimate = stage.estimate();
  EXPECT_NEAR(estimate.friction_Ns_m.quantity.value, 2, 1e-12);
  EXPECT_NEAR(estimate.friction_Ns_m.quantity.standard_deviation, 0.5, 1e-12);
  EXPECT_EQ(estimate.friction_Ns_m.quantity.provenance, Provenance::assumed);
}

// A point that nothing drives or brakes, measured now early and now late in the drive's interval.
TEST(JointIdentification, TakesPositionsWhereTheyWereMeasured) {
  constexpr double kT_s = 0.01, kSpeed_m_s = 0.1;
  JointParameters parameters;
  parameters.mass_kg = {0.25, 1e-3};
  parameters.friction_Ns_m = {0, 1e-3};
  parameters.stiffness_N_m = {0, 1e-3};
  parameters.offset_N = {0, 1e-3};
  JointIdentification<double> stage(parameters);
  for (int i = 0; i < 200; ++i) {
    stage.drive(kT_s, 0);
    const double share = i % 2 == 0 ? 0.2 : 0.9;
    const double z = kSpeed_m_s * kT_s * (i + share);
    const auto estimate = stage.measure(share, z, 1e-5);
    if (i < 20) continue;
    ASSERT_EQ(estimate.outcome, JointOutcome::updated) << i;
    ASSERT_LT(estimate.nis, 1) << i;
    ASSERT_NEAR(estimate.velocity_m_s, kSpeed_m_s, 5e-3) << i;
  }
}

// At a constant speed all of the drive is friction: what the drive may miss of it, the friction may
// be wrong by, however long it lasts.
TEST(JointIdentification, FrictionMayBeWrongByTheShareThatTheDriveMisses) {
  constexpr double kT_s = 0.01, kSpeed_m_s = 0.1, kFriction_Ns_m = 2, kShare = 0.1;
  JointParameters parameters;
  parameters.mass_kg = {0.25, 1e-3};
  parameters.friction_Ns_m = {0, 10};
  parameters.stiffness_N_m = {0, 1e-3};
  parameters.offset_N = {0, 1e-3};
  parameters.drive.gain_sd = parameters.drive.delay_sd_s = 0;
  parameters.drive.missing_share = kShare;
  JointIdentification<double> stage(parameters);
  for (int i = 0; i < 800; ++i) {
    (void)stage.step(kT_s, kFriction_Ns_m * kSpeed_m_s, kSpeed_m_s * kT_s * i, 1e-5);
    if (i != 199 && i != 799) continue;
    const auto friction = stage.estimate().friction_Ns_m;
    EXPECT_NEAR(friction.fitted, kFriction_Ns_m, 0.05);
    EXPECT_NEAR(friction.fitted_sd, kShare * kFriction_Ns_m, 0.02 * kShare * kFriction_Ns_m) << i;
    EXPECT_LT(friction.sampling_sd, 0.1 * friction.fitted_sd);
  }
}

// A block that slides on dry ground: what brakes it is constant.
TEST(JointIdentification, FindsTheCoulombFrictionOfASlidingBlock) {
  constexpr double kT_s = 0.002, kSpeed_m_s = 0.8, kMass_kg = 0.5, kCoulomb_N = 0.4;
  JointParameters parameters;
  parameters.mass_kg = {kMass_kg, 1e-4};
  parameters.friction_Ns_m = {0, 1e-4};
  parameters.stiffness_N_m = {0, 1e-4};
  parameters.offset_N = {0, 1e-4};
  parameters.coulomb_N = {0, 1};
  parameters.velocity_sd_m_s = 1;
  JointIdentification<double> stage(parameters);
  JointEstimate<double> estimate;
  for (int i = 0; i < 400; ++i) {
    const double t = i * kT_s;
    estimate = stage.step(kT_s, 0, kSpeed_m_s * t - kCoulomb_N / kMass_kg * t * t / 2, 1e-6);
  }
  EXPECT_NEAR(estimate.coulomb_N.fitted, kCoulomb_N, 0.02);
  EXPECT_LT(estimate.coulomb_N.sampling_sd, 0.02);
}

}  // namespace
}  // namespace condyle
