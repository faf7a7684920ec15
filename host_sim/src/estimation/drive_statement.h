// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "condyle/estimator/impedance/impedance_parameters.h"

namespace condyle::host {

/// The user's statements about a measured drive, and about contacts, at which it is not the whole
/// force. They override the parameter file.
struct DriveStatement {
  std::optional<double> missing_share, gain_sd, position_scale_sd, axis_angle_sd_deg, noise_sd_N,
      delay_ms, delay_sd_ms;
  std::optional<double> coulomb_sd_N, contact_above_mm, contact_below_mm;
  bool fits_delay = false;

  bool is_given() const {
    return missing_share || gain_sd || position_scale_sd || axis_angle_sd_deg || noise_sd_N ||
           delay_ms || delay_sd_ms || coulomb_sd_N || contact_above_mm || contact_below_mm ||
           fits_delay;
  }
  void apply(ImpedanceParameters& impedance) const;
};

}  // namespace condyle::host
