// SPDX-License-Identifier: Apache-2.0
#include "hosted/devices/device_text.h"

#include <fmt/format.h>

#include <cmath>

#include "condyle/hal/hid/descriptor_profile.h"
#include "hosted/files/input_error.h"

namespace condyle::host {

std::string reports_text(const hal::DeviceProfile& profile, const hal::ReportCounts& reports,
                         const hal::TransportCounts& transport) {
  std::string text = fmt::format("{} reports received, ", reports.received);
  text += profile.sequence ? fmt::format("{} lost", reports.lost)
                           : "losses not known (the profile has no counter)";
  const auto add = [&text](std::uint64_t count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(reports.too_short, "too short");
  add(reports.wrong_checksum, "with a wrong checksum");
  add(reports.counter_out_of_range, "with a counter out of range");
  add(reports.duplicated, "sent twice");
  add(reports.other_reports, "with another report id");
  add(reports.unknown_losses - reports.unknown_reconnections, "gaps of unknown length");
  add(reports.unknown_reconnections,
      "reconnections that restarted the counter (reports lost there: unknown, at most those in the "
      "kernel's queue and those sent before reading resumed)");
  add(reports.sequence_restarts, "restarts of the counter");
  add(reports.clock_jumps, "jumps of the device's clock");
  add(transport.disconnections, "disconnections");
  add(transport.stalls, "stalls");
  add(transport.transfer_errors, "transfer errors");
  add(transport.oversized, "oversized");
  return text;
}

std::string clock_text(const hal::ClockFit& fit) {
  if (fit.pace() > 0 && std::abs(fit.pace() - 1) > 0.01) {
    return fmt::format(
        "device clock: WRONG, it runs {:.4g} times as fast as the host's; times, velocities and "
        "forces "
        "are wrong; check unit, scale and width in the profile",
        fit.pace());
  }
  if (fit.seconds_fitted() < 3 && fit.steps() > 0) {
    return fmt::format(
        "device clock: it does not keep the host's time ({} steps so far); check its unit and "
        "width "
        "in the profile",
        fit.steps());
  }
  if (fit.seconds_fitted() < 3) {
    return "device clock: the run is too short to compare it with the host's";
  }
  std::string text = fmt::format(
      "device clock {:.1f} ppm {} than the host's, +-{:.1f} (2 standard deviations); earliest "
      "arrivals "
      "of each second spread by {:.0f} us",
      std::abs(fit.drift_ppm()), fit.drift_ppm() < 0 ? "faster" : "slower",
      2 * fit.drift_uncertainty_ppm(), fit.residual_s() * 1e6);
  if (fit.steps() > 0) text += fmt::format("; the clocks stepped apart {} times", fit.steps());
  return text;
}

void require_position(const hal::DeviceProfile& profile, const std::string& where) {
  if (profile.measures_position()) return;
  throw InputError(where, "has no coordinates: it describes a companion, not a facebow",
                   "give the profile of a facebow, and this one to condyle record --companion");
}

void complete_profile(hal::DeviceProfile& profile, std::span<const std::uint8_t> descriptor,
                      const std::string& where) {
  if (!profile.descriptor_axes) return;
  const auto fail = [&](const std::string& problem) {
    throw InputError(where, problem, "give the coordinates in the profile instead");
  };
  if (descriptor.empty()) {
    fail("has no report descriptor, in which the profile expects the coordinates");
  }
  const auto decoded = hal::parse_report_descriptor(descriptor);
  if (!decoded.descriptor) {
    fail(fmt::format("byte {} of its report descriptor: {}", decoded.error.byte_offset,
                     decoded.error.reason));
  }
  const auto completed = hal::complete_from_descriptor(profile, *decoded.descriptor);
  if (!completed.profile) fail(completed.reason);
  profile = *completed.profile;
}

}  // namespace condyle::host
