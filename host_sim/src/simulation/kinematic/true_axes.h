// SPDX-License-Identifier: Apache-2.0
// Where the axes of an opening truly cross the midsagittal plane.
#pragma once

#include <string>
#include <vector>

#include "simulation/kinematic/kinematic_jaw.h"
#include "simulation/kinematic/true_measures.h"

namespace condyle::host {

struct TrueAxisValue {
  std::string reading;
  double value_mm;
};

/// Of the way `out` of an opening: hinge_axis_*, helical_axis_*, finite_axes_*,
/// instantaneous_axis_* (mm). Those whose angle is too small are absent.
std::vector<TrueAxisValue> true_axes(const KinematicJaw& jaw, const truth::Span& out);

}  // namespace condyle::host
