// SPDX-License-Identifier: Apache-2.0
// A value of one fit, with what stands beside its scatter (point_judgement.h).
#pragma once

#include "condyle/estimator/impedance/joint_parameters.h"
#include "condyle/estimator/impedance/regression_fit.h"

namespace condyle {

/// True where a parameter was stated to wander.
inline bool has_walk(const JointParameters& parameters) {
  for (const JointPrior* prior :
       {&parameters.friction_Ns_m, &parameters.mass_kg, &parameters.stiffness_N_m,
        &parameters.offset_N, &parameters.coulomb_N}) {
    if (prior->walk_per_root_s > 0) return true;
  }
  return false;
}

namespace internal {

inline double square(double value) {
  return value * value;
}

/// A value of one fit, with what stands beside its scatter.
struct Candidate {
  FittedValue fit;
  double discrepancy2 = 0;
  double all2(double delay_sd_s) const {
    return square(fit.sd) + discrepancy2 + delay2(delay_sd_s);
  }
  double delay2(double delay_sd_s) const {
    return square(fit.per_delay * delay_sd_s) + 3 * square(fit.per_delay2 * square(delay_sd_s) / 2);
  }
};

}  // namespace internal
}  // namespace condyle
