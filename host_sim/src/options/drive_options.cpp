// SPDX-License-Identifier: Apache-2.0
#include "options/drive_options.h"
#include "options/command_line.h"

#include <fmt/format.h>

#include <numbers>

namespace condyle::host {

void DriveOptions::add_to(CommandLine line) {
  const CommandLine command = line.group("Measured drive");
  command
      .add_option("--drive-missing", missing_share,
                  "Largest share of the total force that the drive may miss; default: not known")
      .number_in({0, 1});
  command.add_option("--drive-gain-sd", gain_sd, "Relative uncertainty of the drive's gain (0.01)")
      .number_in({0, 1});
  command
      .add_option("--position-scale-sd", position_scale_sd,
                  "Relative uncertainty of the scale of the positions (0)")
      .number_in({0, 1});
  command
      .add_option("--drive-angle-sd-deg", axis_angle_sd_deg,
                  "Uncertainty of the angle between the drive's axis and the followed one (0)")
      .number_in({0, 57});
  command
      .add_option(
          "--drive-noise-N", noise_sd_N,
          "Stated noise of each sample of the drive, for comparison with the noise found (0.01)")
      .number_in({1e-9, 1e3});
  command.add_option("--drive-delay-ms", delay_ms, "Delay of the drive's time stamps (0)")
      .number_in({-1000, 1000});
  command.add_option("--drive-delay-sd-ms", delay_sd_ms, "Uncertainty of that delay (5)")
      .number_in({0, 1000});
  command.add_flag(
      "--drive-fit-delay", fits_delay,
      "Also estimate the delay, starting from these values, instead of widening the intervals");
  command
      .add_option("--coulomb-sd-N", coulomb_sd_N,
                  "Estimate Coulomb friction separately; its expected size")
      .number_in({0, 1e6});
  constexpr const char* contact = "are not used: teeth or food may touch there";
  command
      .add_option("--contact-above-mm", contact_above_mm,
                  fmt::format("Positions above {}", contact))
      .number_in({-1e6, 1e6});
  command
      .add_option("--contact-below-mm", contact_below_mm,
                  fmt::format("Positions below {}", contact))
      .number_in({-1e6, 1e6});
}

void DriveOptions::apply(ImpedanceParameters& impedance) const {
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
