// SPDX-License-Identifier: Apache-2.0
// What the identification from EMG knows, and why a value is not shown.
#pragma once

#include <array>
#include <cstdint>

#include "condyle/estimator/emg/muscle_force.h"
#include "condyle/estimator/provenance.h"

namespace condyle {

/// What a position did to the identification.
enum class EmgOutcome : std::uint8_t {
  waits,     ///< no EMG came since the last interruption
  started,   ///< the first one, or the first after an interruption
  updated,   ///< it was taken
  rejected,  ///< it lies beyond the gate; after three in a row the point's place starts anew
  refused,   ///< a state was not usable: all starts anew
};

/// Why a value is not shown as derived.
enum class EmgLimit : std::uint8_t {
  none,         ///< it is
  no_emg,       ///< no EMG came
  too_early,    ///< too few positions were taken to judge the model by
  model,        ///< the innovations are not what they would be if the model held
  information,  ///< the measurements tell less than the prior does
  resolution,   ///< they tell too little for the user
  mass,         ///< likewise; most of it is the assumed mass's uncertainty,
  lag,          ///< that of the force's lag behind the EMG,
  force,        ///< or what the muscles' force gets wrong
  scale,        ///< of stiffness and offset: no gain is known, and errors of the force draw all of
                ///< them towards 0 alike
};

/// Number of limits.
inline constexpr std::size_t kEmgLimits = 10;

/// Name of a limit as it stands in files and summaries.
constexpr const char* limit_name(EmgLimit limit) {
  constexpr const char* names[kEmgLimits] = {
      "",           "no_emg", "too_early", "model", "information",
      "resolution", "mass",   "lag",       "force", "scale"};
  return names[static_cast<int>(limit)];
}

/// One value of the model.
template <class Scalar>
struct EmgValue {
  Quantity<Scalar> quantity;  ///< to be shown: the prior's, assumed, where it is not derived
  Scalar fitted = 0;          ///< by the filter and the assumed mass, whether it is known or not
  Scalar fitted_sd = 0;       ///< with what no number of samples averages out
  Scalar filter_sd = 0;       ///< without
  Scalar information = 0;     ///< its information share (provenance.h), by fitted_sd
  EmgLimit limit = EmgLimit::no_emg;
};

/// What is known after a position.
template <class Scalar>
struct EmgEstimate {
  EmgValue<Scalar> friction_Ns_m, stiffness_N_m, offset_N;
  std::array<EmgValue<Scalar>, kMostMuscles> gain;
  Quantity<Scalar> mass_kg;  ///< assumed
  Scalar position_m = 0, velocity_m_s = 0;
  Scalar force_error_N = 0;                               ///< d m
  Scalar force_rms_N = 0;                                 ///< rms(F) m
  Scalar nis = std::numeric_limits<Scalar>::quiet_NaN();  ///< of the position; NaN: not taken
  Scalar mean_nis = 0;                ///< of all that were taken; at most 1 where the model holds
  Scalar innovation_correlation = 0;  ///< of neighbours; not above 0 where the model holds
  Scalar found_error_share = 0;       ///< rms(d) / rms(F); at most error_share where that holds
  Scalar noise_share = 0;             ///< s, as learned
  Scalar rejected_share = 0;          ///< of the positions
  std::uint64_t restarts = 0;         ///< of the whole filter
  EmgOutcome outcome = EmgOutcome::waits;
};

}  // namespace condyle
