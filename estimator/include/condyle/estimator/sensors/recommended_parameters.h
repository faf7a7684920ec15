// SPDX-License-Identifier: Apache-2.0
// Parameters of the sensors, in parts: a target has only those that it uses. A parameter file has
// them all.
#pragma once

#include "condyle/estimator/changes/change_parameters.h"
#include "condyle/estimator/impedance/impedance_parameters.h"
#include "condyle/estimator/motion/motion_parameters.h"

namespace condyle {

/// Most kernels of the regression in motion_corrector.h.
inline constexpr int kMostKernels = 96;

/// Learning from the recording itself (learned_sensor.h).
struct LearningParameters {
  double kernels = kMostKernels;  ///< of the regression, rounded down; 0: nothing is learned
};

/// Calls `visit` as visit_motion_fields does, for each numeric field of a LearningParameters.
template <class Parameters, class Visitor>
constexpr void visit_learning_fields(Parameters& learning, Visitor&& visit) {
  visit("learning", "kernels", &learning.kernels, std::size_t{1}, "kernels",
        Range{0, kMostKernels});
}

/// Parameters of motion, and of friction and mass for a measured drive (driven_sensor.h).
struct DrivenParameters : MotionEstimatorParameters {
  LearningParameters learning;
  ImpedanceParameters impedance;
};

/// Parameters in a parameter file of the recommended estimator.
struct RecommendedParameters : DrivenParameters {
  WatchParameters changes;  ///< for detecting changes of damping
};

/// Like visit_motion_fields, for each numeric field of a DrivenParameters.
template <class Parameters, class Visitor>
constexpr void visit_driven_fields(Parameters& parameters, Visitor&& visit) {
  visit_motion_fields(parameters, visit);
  visit_impedance_fields(parameters.impedance, visit);
}

/// Like visit_motion_fields, for each numeric field of a RecommendedParameters.
template <class Parameters, class Visitor>
constexpr void visit_recommended_fields(Parameters& parameters, Visitor&& visit) {
  visit_driven_fields(parameters, visit);
  visit_learning_fields(parameters.learning, visit);
  visit_change_fields(parameters.changes, visit);
}

/// True if is_valid holds for the motion's, and every other field is in its range.
constexpr bool is_valid(const DrivenParameters& parameters) {
  bool valid = is_valid(static_cast<const MotionEstimatorParameters&>(parameters));
  const auto check = [&valid](const char*, const char*, const double* values, std::size_t,
                              const char*,
                              Range range) { valid = valid && range.contains(*values); };
  visit_impedance_fields(parameters.impedance, check);
  visit_learning_fields(parameters.learning, check);
  return valid;
}

/// The same for RecommendedParameters.
constexpr bool is_valid(const RecommendedParameters& parameters) {
  bool valid = is_valid(static_cast<const DrivenParameters&>(parameters));
  visit_change_fields(parameters.changes, [&valid](const char*, const char*, const double* values,
                                                   std::size_t, const char*, Range range) {
    valid = valid && range.contains(*values);
  });
  return valid;
}

}  // namespace condyle
