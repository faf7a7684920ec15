// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "condyle/estimator/joint_identification.h"
#include "consistency/driven_chewing.h"

namespace condyle::testing_support {

/// As DrivenChewing says: the whole drive, and well calibrated.
inline JointParameters matched() {
  JointParameters parameters;
  parameters.drive.noise_sd_N = DrivenChewing::kDriveSd_N;
  parameters.drive.gain_sd = 0;
  parameters.drive.delay_sd_s = 0;
  parameters.drive.missing_share = 0;
  return parameters;
}

/// NEES of friction and mass together, by the delta method.
inline double nees(const JointFilterEstimate<double>& estimate, const DrivenTruth& truth) {
  const double m = estimate.mass_kg.fitted, kv = estimate.friction_Ns_m.fitted;
  Eigen::Matrix2d covariance;
  covariance << std::pow(estimate.friction_Ns_m.sampling_sd, 2), estimate.friction_mass_covariance,
      estimate.friction_mass_covariance, std::pow(estimate.mass_kg.sampling_sd, 2);
  const Eigen::Vector2d error(kv - truth.friction_Ns_m, m - truth.mass_kg);
  return error.dot(covariance.inverse() * error);
}

}  // namespace condyle::testing_support
