// SPDX-License-Identifier: Apache-2.0
// The results of the identification of a point: values, their uncertainty, and why they are
// withheld.
#pragma once

#include "condyle/estimator/provenance.h"

namespace condyle {

/// Why a value is not measured.
enum class ImpedanceLimit : std::uint8_t {
  none,                ///< it is measured
  no_drive,            ///< no drive was measured together with positions
  too_slow,            ///< the rate of positions or drive is too low
  too_early,           ///< too little was recorded to judge the model
  dynamics,            ///< the drive's sensor, or the tracker, is delayed or smoothed
  noise,               ///< the residual is not the noise that the samples show
  drive_reversed,      ///< the mass would be negative: the drive's sign is reversed
  implausible_mass,    ///< the mass is outside the stated range: a unit is wrong
  mass_stated,         ///< the motion shows another mass than the known one
  changing,            ///< the parameters, or the drive's delay, changed along the recording
  delay_stated,        ///< the drive's delay differs from the stated one
  negative_friction,   ///< friction would be negative: the drive is not the total force
  excitation,          ///< the motion is too weak, or too uniform, against the noise
  mass_or_stiffness,   ///< the motion does not separate mass from the spring's shape
  friction_or_delay,   ///< the motion does not separate friction from the drive's delay
  viscous_or_coulomb,  ///< the motion does not separate viscous from sliding friction
  resolution,          ///< too little was recorded for the stated resolution
  gain,                ///< the drive's calibration is too uncertain,
  delay,               ///< or the drive's delay, which acts like friction,
  missing,             ///< or the share that the drive may miss
  smoothing,           ///< the samples' noise is not white, and smoothing may change it
};

/// True if no value may be stated: too little was measured, or a test failed.
constexpr bool is_failure(ImpedanceLimit limit) {
  return limit >= ImpedanceLimit::no_drive && limit <= ImpedanceLimit::negative_friction;
}

/// Number of limits.
inline constexpr std::size_t kImpedanceLimits = 21;

/// Name of a limit in files and summaries.
constexpr const char* limit_name(ImpedanceLimit limit) {
  constexpr const char* names[kImpedanceLimits] = {"",
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

/// A value of the regression.
template <class Scalar>
struct IdentifiedValue : LimitedValue<Scalar, ImpedanceLimit, ImpedanceLimit::no_drive> {
  /// Recorded time that would suffice; set if the limit is resolution.
  Scalar needed_s = std::numeric_limits<Scalar>::quiet_NaN();
};

/// Values of one fit, which belong together even if withheld.
template <class Scalar>
struct PointValues {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();
  Scalar friction_Ns_m = kNone, mass_kg = kNone, stiffness_N_m = kNone, offset_N = kNone;
  Scalar delay_s = 0;
};

/// The present results.
template <class Scalar>
struct ImpedanceEstimate {
  IdentifiedValue<Scalar> friction_Ns_m, mass_kg, stiffness_N_m, offset_N;
  IdentifiedValue<Scalar> coulomb_N;  ///< assumed to be zero unless it is fitted
  IdentifiedValue<Scalar> delay_s;    ///< of the drive; assumed unless it is fitted
  PointValues<Scalar> plain;          ///< by the plain model, all from one fit
  Scalar used_s = 0;                  ///< recorded time used for the values
  /// Noise of a sample of the drive and of the position, by their own differences; NaN before.
  Scalar drive_noise_sd_N = std::numeric_limits<Scalar>::quiet_NaN();
  Scalar position_noise_sd_m = std::numeric_limits<Scalar>::quiet_NaN();
  /// rms of the drive, of it about its mean, of velocity and of position about its mean, as the
  /// kernel passes them; NaN before.
  Scalar drive_rms_N = PointValues<Scalar>::kNone, drive_variation_rms_N = drive_rms_N;
  Scalar velocity_rms_m_s = drive_rms_N, position_rms_m = drive_rms_N;
  /// Mean square residual of the model relative to that of the noise; 1 if the model holds.
  Scalar residual_ratio = std::numeric_limits<Scalar>::quiet_NaN();
};

}  // namespace condyle
