// SPDX-License-Identifier: Apache-2.0
// What the joint identification says of a point: values, how well they are known, and why not.
#pragma once

#include "condyle/estimator/provenance.h"

namespace condyle {

/// What a position did to the identification.
enum class JointOutcome : std::uint8_t {
  waits,     ///< no drive was measured since the last interruption
  started,   ///< the first one, or the first after an interruption
  updated,   ///< it was taken
  held,      ///< it was taken for the point's place alone, which moves too little to tell more
  paused,    ///< it lies where teeth or food may touch: not taken
  rejected,  ///< it lies beyond the gate; after three in a row the point's place starts anew
  refused,   ///< a state was not usable, or the place was lost for long and nothing had been
             ///< proved by then: the filter starts anew
};

/// Why a value is not measured.
enum class JointLimit : std::uint8_t {
  none,                ///< it is
  no_drive,            ///< no drive was measured
  too_early,           ///< too few positions were taken to judge the model by
  model,               ///< the innovations are not what they would be if the model held
  information,         ///< the measurements tell less than the prior does
  resolution,          ///< they tell too little for the user
  friction_or_delay,   ///< likewise: they would, were the drive's delay known
  mass_or_stiffness,   ///< likewise, were mass or stiffness, the other of the two, known
  viscous_or_coulomb,  ///< likewise, for the two kinds of friction
  gain,                ///< likewise; most of it is the drive's calibration,
  delay,               ///< the drive's delay, which acts like friction,
  missing,             ///< or what the drive may miss
};

/// Number of limits.
inline constexpr std::size_t kJointLimits = 12;

/// Name of a limit as it stands in files and summaries.
constexpr const char* limit_name(JointLimit limit) {
  constexpr const char* names[kJointLimits] = {"",
                                               "no_drive",
                                               "too_early",
                                               "model",
                                               "information",
                                               "resolution",
                                               "friction_or_delay",
                                               "mass_or_stiffness",
                                               "viscous_or_coulomb",
                                               "gain",
                                               "delay",
                                               "missing"};
  return names[static_cast<int>(limit)];
}

/// One identified value, what is known of it, and whether it is.
template <class Scalar>
struct IdentifiedValue {
  Quantity<Scalar> quantity;  ///< to be shown: the prior's, assumed, where it is not measured
  Scalar fitted = 0;          ///< by the filter, whether it is known or not
  Scalar fitted_sd = 0;       ///< with what is taken for granted
  Scalar filter_sd = 0;       ///< without: the posterior Cramer-Rao bound at the estimate
  Scalar information = 0;     ///< its information share (provenance.h)
  JointLimit limit = JointLimit::no_drive;
};

/// What is known after a sample.
template <class Scalar>
struct JointEstimate {
  IdentifiedValue<Scalar> friction_Ns_m, mass_kg, stiffness_N_m, offset_N;
  IdentifiedValue<Scalar> coulomb_N;    ///< assumed to be none unless it is fitted
  IdentifiedValue<Scalar> delay_s;      ///< of the drive; assumed unless it is fitted
  Scalar friction_mass_covariance = 0;  ///< of the filter (Ns/m kg)
  Scalar position_m = 0, velocity_m_s = 0;
  Scalar nis = std::numeric_limits<Scalar>::quiet_NaN();  ///< of the position; NaN: not taken
  Scalar mean_nis = 0;                ///< of all that were taken; 1 where the model holds
  Scalar innovation_correlation = 0;  ///< of neighbours among them; 0 where the model holds
  /// Smallest information share of any combination of what is fitted: 0 where some combination is
  /// not observed at all, 1 where all are known.
  Scalar observability = 0;
  JointOutcome outcome = JointOutcome::waits;
};

}  // namespace condyle
