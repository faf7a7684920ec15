// SPDX-License-Identifier: Apache-2.0
// What is said of a device, live and replayed.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "condyle/hal/hid/device_profile.h"
#include "condyle/hal/report/clock_fit.h"
#include "condyle/hal/report/raw_report.h"
#include "condyle/hal/report/report_tracker.h"

namespace condyle::host {

/// "600 reports received, 3 lost, ..."; what did not happen is left out.
std::string reports_words(const hal::DeviceProfile& profile, const hal::ReportCounts& reports,
                          const hal::TransportCounts& transport);

/// How the device's clock lies to the host's.
std::string clock_words(const hal::ClockFit& fit);

/// An InputError that begins with `where` if the profile's device measures no position.
void require_position(const hal::DeviceProfile& profile, const std::string& where);

/// Finds the coordinates in the report descriptor where the profile leaves them to it; an
/// InputError that begins with `where` if they are not to be found.
void complete_profile(hal::DeviceProfile& profile, std::span<const std::uint8_t> descriptor,
                      const std::string& where);

}  // namespace condyle::host
