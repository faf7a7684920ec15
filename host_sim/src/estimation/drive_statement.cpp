// SPDX-License-Identifier: Apache-2.0
#include "estimation/drive_statement.h"

#include <numbers>

namespace condyle::host {

void DriveStatement::apply(ImpedanceParameters& impedance) const {
  DriveParameters& drive = impedance.drive;
  drive.missing_share = missing_share.value_or(drive.missing_share);
  drive.gain_sd = gain_sd.value_or(drive.gain_sd);
  drive.position_scale_sd = position_scale_sd.value_or(drive.position_scale_sd);
  if (axis_angle_sd_deg) drive.axis_angle_sd_rad = *axis_angle_sd_deg * std::numbers::pi / 180;
  drive.noise_sd_N = noise_sd_N.value_or(drive.noise_sd_N);
  if (delay_ms) drive.delay_s = *delay_ms * 1e-3;
  if (delay_sd_ms) drive.delay_sd_s = *delay_sd_ms * 1e-3;
  if (fits_delay) impedance.delay = DelayModel::fitted;
  impedance.coulomb_N.sd = coulomb_sd_N.value_or(impedance.coulomb_N.sd);
  if (contact_above_mm) impedance.contact_above_m = *contact_above_mm * 1e-3;
  if (contact_below_mm) impedance.contact_below_m = *contact_below_mm * 1e-3;
}

}  // namespace condyle::host
