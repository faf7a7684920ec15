// SPDX-License-Identifier: Apache-2.0
// What a measured drive tells of friction and mass, in words.
#pragma once

#include <string>

#include "condyle/estimator/impedance/joint_estimate.h"
#include "condyle/estimator/impedance/joint_parameters.h"

namespace condyle::host {

/// Values with intervals, or why they are not known; what speaks of wrong units; what they rest on.
std::string joint_text(const JointEstimate<double>& joint, const JointParameters& parameters);

}  // namespace condyle::host
