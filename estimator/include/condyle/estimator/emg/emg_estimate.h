// SPDX-License-Identifier: Apache-2.0
// The results of the identification from EMG, and why a value is withheld.
#pragma once

#include <array>
#include <cstdint>

#include "condyle/estimator/emg/muscle_force.h"
#include "condyle/estimator/provenance.h"

namespace condyle {

/// Effect of a position on the identification.
enum class EmgOutcome : std::uint8_t {
  waits,     ///< no EMG since the last interruption
  started,   ///< the first one, or the first after an interruption
  updated,   ///< it was used
  rejected,  ///< it lies beyond the gate; after three in a row the position state restarts
  refused,   ///< a state was not usable: the filter restarts
};

/// Why a value is not shown as derived.
enum class EmgLimit : std::uint8_t {
  none,         ///< it is derived
  no_emg,       ///< there was no EMG
  too_early,    ///< too few positions to judge the model
  model,        ///< the innovations contradict the model
  information,  ///< the measurements contribute less than the prior
  resolution,   ///< the uncertainty is too large for the user
  mass,         ///< the same, mostly from the uncertainty of the assumed mass,
  lag,          ///< from that of the force's lag behind the EMG,
  force,        ///< or from errors of the muscles' force
  scale,        ///< of stiffness and offset: no gain is known, and errors of the force draw all of
                ///< them towards 0 alike
};

/// Number of limits.
inline constexpr std::size_t kEmgLimits = 10;

/// Name of a limit in files and summaries.
constexpr const char* limit_name(EmgLimit limit) {
  constexpr const char* names[kEmgLimits] = {
      "",           "no_emg", "too_early", "model", "information",
      "resolution", "mass",   "lag",       "force", "scale"};
  return names[static_cast<int>(limit)];
}

/// A value of the filter at the assumed mass; derived if it is shown.
template <class Scalar>
struct EmgValue : LimitedValue<Scalar, EmgLimit, EmgLimit::no_emg> {
  Scalar information = 0;  ///< information share (provenance.h) by fitted_sd
};

/// The results after a position.
template <class Scalar>
struct EmgEstimate {
  EmgValue<Scalar> friction_Ns_m, stiffness_N_m, offset_N;
  std::array<EmgValue<Scalar>, kMostMuscles> gain;
  Quantity<Scalar> mass_kg;  ///< assumed
  Scalar position_m = 0, velocity_m_s = 0;
  Scalar force_error_N = 0;                               ///< d m
  Scalar force_rms_N = 0;                                 ///< rms(F) m
  Scalar nis = std::numeric_limits<Scalar>::quiet_NaN();  ///< of the position; NaN: not taken
  Scalar mean_nis = 0;                ///< of all that were used; at most 1 if the model holds
  Scalar innovation_correlation = 0;  ///< of neighbours; not above 0 if the model holds
  Scalar found_error_share = 0;       ///< rms(d) / rms(F); at most error_share if that is right
  Scalar noise_share = 0;             ///< s, as learned
  Scalar rejected_share = 0;          ///< of the positions
  std::uint64_t restarts = 0;         ///< of the whole filter
  EmgOutcome outcome = EmgOutcome::waits;
};

}  // namespace condyle
