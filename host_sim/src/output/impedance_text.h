// SPDX-License-Identifier: Apache-2.0
// Friction and mass from a measured drive, as text.
#pragma once

#include <string>

#include "condyle/estimator/impedance/impedance_estimate.h"
#include "condyle/estimator/impedance/impedance_parameters.h"

namespace condyle::host {

/// Why `value` is not measured, and the remedy, after a colon; empty if it is measured.
std::string limit_text(const IdentifiedValue<double>& value);

/// Values with intervals, or why they are not known; signs of wrong units; the assumptions.
std::string impedance_text(const ImpedanceEstimate<double>& impedance,
                           const ImpedanceParameters& parameters);

}  // namespace condyle::host
