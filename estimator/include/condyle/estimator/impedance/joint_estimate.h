// SPDX-License-Identifier: Apache-2.0
// What the identification says of a point: values, how well they are known, and why not.
#pragma once

#include "condyle/estimator/provenance.h"

namespace condyle {

/// Why a value is not measured.
enum class JointLimit : std::uint8_t {
  none,                ///< it is
  no_drive,            ///< no drive was measured while positions were
  too_slow,            ///< positions or drive come too seldom
  too_early,           ///< too little was recorded to judge by
  dynamics,            ///< the drive's sensor, or the tracker, follows late or smoothed
  noise,               ///< what is left over is not the noise that the samples show
  drive_reversed,      ///< the mass would be negative: the drive's sign is reversed
  implausible_mass,    ///< the mass is outside the stated range: a unit is wrong
  mass_stated,         ///< the motion shows another mass than the one that is known
  changing,            ///< the parameters, or the drive's delay, changed along the recording
  delay_stated,        ///< the drive's delay is not what was stated
  negative_friction,   ///< friction would be negative: the drive is not all that drives
  excitation,          ///< the motion is too weak, or too uniform, against the noise
  mass_or_stiffness,   ///< the motion does not tell mass from the spring's shape
  friction_or_delay,   ///< the motion does not tell friction from the drive's delay
  viscous_or_coulomb,  ///< the motion does not tell viscous from sliding friction
  resolution,          ///< too little was recorded for the stated resolution
  gain,                ///< the drive's calibration is too uncertain for it,
  delay,               ///< or the drive's delay, which acts like friction,
  missing,             ///< or what the drive may miss
  smoothing,           ///< the samples' noise is not white, and smoothing may change it
};

/// True where nothing may be said of any value: too little was measured, or a test speaks.
constexpr bool is_failure(JointLimit limit) {
  return limit >= JointLimit::no_drive && limit <= JointLimit::negative_friction;
}

/// Number of limits.
inline constexpr std::size_t kJointLimits = 21;

/// Name of a limit as it stands in files and summaries.
constexpr const char* limit_name(JointLimit limit) {
  constexpr const char* names[kJointLimits] = {"",
                                               "no_drive",
                                               "too_slow",
                                               "too_early",
                                               "dynamics",
                                               "noise",
                                               "drive_reversed",
                                               "implausible_mass",
                                               "mass_stated",
                                               "changing",
                                               "delay_stated",
                                               "negative_friction",
                                               "excitation",
                                               "mass_or_stiffness",
                                               "friction_or_delay",
                                               "viscous_or_coulomb",
                                               "resolution",
                                               "gain",
                                               "delay",
                                               "missing",
                                               "smoothing"};
  return names[static_cast<int>(limit)];
}

/// One identified value, what is known of it, and whether it is.
template <class Scalar>
struct IdentifiedValue {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();
  Quantity<Scalar> quantity;   ///< to be shown: the prior's, assumed, where it is not measured
  Scalar fitted = kNone;       ///< by the regression, whether it is known or not
  Scalar fitted_sd = kNone;    ///< with what is taken for granted; infinite where it has no end
  Scalar sampling_sd = kNone;  ///< without: what the recording's own scatter says
  Scalar needed_s = kNone;     ///< recorded time that would suffice; where the limit is resolution
  JointLimit limit = JointLimit::no_drive;
};

/// Values of one fit, which belong together whether they are known or not.
template <class Scalar>
struct PointValues {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();
  Scalar friction_Ns_m = kNone, mass_kg = kNone, stiffness_N_m = kNone, offset_N = kNone;
  Scalar delay_s = 0;
};

/// What is known so far.
template <class Scalar>
struct JointEstimate {
  IdentifiedValue<Scalar> friction_Ns_m, mass_kg, stiffness_N_m, offset_N;
  IdentifiedValue<Scalar> coulomb_N;  ///< assumed to be none unless it is fitted
  IdentifiedValue<Scalar> delay_s;    ///< of the drive; assumed unless it is fitted
  PointValues<Scalar> plain;          ///< by the plain model, all from one fit
  Scalar used_s = 0;                  ///< time that the values rest on
  /// Noise of a sample of the drive and of the position, by their own differences; NaN before.
  Scalar drive_noise_sd_N = std::numeric_limits<Scalar>::quiet_NaN();
  Scalar position_noise_sd_m = std::numeric_limits<Scalar>::quiet_NaN();
  /// rms of the drive, of it about its mean, of velocity and of position about its mean, as the
  /// kernel passes them; NaN before.
  Scalar drive_rms_N = PointValues<Scalar>::kNone, drive_variation_rms_N = drive_rms_N;
  Scalar velocity_rms_m_s = drive_rms_N, position_rms_m = drive_rms_N;
  /// Mean square of what the model leaves over what noise makes of it; 1 where the model holds.
  Scalar residual_ratio = std::numeric_limits<Scalar>::quiet_NaN();
};

}  // namespace condyle
