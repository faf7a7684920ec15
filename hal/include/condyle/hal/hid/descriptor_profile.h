// SPDX-License-Identifier: Apache-2.0
// Makes a profile for a device that describes itself: its report descriptor gives the places of X,
// Y and Z and their unit.
#pragma once

#include <optional>
#include <string>

#include "condyle/hal/hid/device_profile.h"
#include "condyle/hal/hid/report_descriptor.h"

namespace condyle::hal {

/// A usable profile, or the reason why there is none.
struct DescriptorProfile {
  std::optional<DeviceProfile> profile;
  std::string reason;  ///< set only if there is no profile
};

/// `base` with the coordinates of one point added: the usages X, Y and Z of the Generic Desktop
/// page (HID Usage Tables, page 0x01, usages 0x30 to 0x32). Each must be in one absolute field with
/// a unit of length, all in one input report. They are turned by `base.descriptor_axes` if it is
/// set. `base.report_id` chooses among several reports. Raw values outside the logical range mean
/// "not measured" (HID 1.11, section 5.10). An ambiguous descriptor is refused.
DescriptorProfile complete_from_descriptor(const DeviceProfile& base,
                                           const ReportDescriptor& descriptor);

}  // namespace condyle::hal
