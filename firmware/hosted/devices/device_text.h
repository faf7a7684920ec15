// SPDX-License-Identifier: Apache-2.0
// Summary lines about a device, live and replayed.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "condyle/hal/hid/device_profile.h"
#include "condyle/hal/report/clock_fit.h"
#include "condyle/hal/report/raw_report.h"
#include "condyle/hal/report/report_tracker.h"

namespace condyle::host {

/// "600 reports received, 3 lost, ..."; counts of 0 are left out.
std::string reports_text(const hal::DeviceProfile& profile, const hal::ReportCounts& reports,
                         const hal::TransportCounts& transport);

/// How the device's clock relates to the host's.
std::string clock_text(const hal::ClockFit& fit);

/// Throws an InputError that begins with `where` if the profile has no position.
void require_position(const hal::DeviceProfile& profile, const std::string& where);

/// If the profile leaves the coordinates to the report descriptor, finds them there. Throws an
/// InputError that begins with `where` if it does not find them.
void complete_profile(hal::DeviceProfile& profile, std::span<const std::uint8_t> descriptor,
                      const std::string& where);

}  // namespace condyle::host
