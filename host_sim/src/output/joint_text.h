// SPDX-License-Identifier: Apache-2.0
// Friction and mass from a measured drive, as text.
#pragma once

#include <string>

#include "condyle/estimator/impedance/joint_estimate.h"
#include "condyle/estimator/impedance/joint_parameters.h"

namespace condyle::host {

/// Values with intervals, or why they are not known; signs of wrong units; the assumptions.
std::string joint_text(const JointEstimate<double>& joint, const JointParameters& parameters);

}  // namespace condyle::host
