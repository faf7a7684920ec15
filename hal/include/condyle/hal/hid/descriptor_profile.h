// SPDX-License-Identifier: Apache-2.0
// A profile from a device that describes itself: its report descriptor says where X, Y and Z are
// and in what unit.
#pragma once

#include <optional>
#include <string>

#include "condyle/hal/hid/device_profile.h"
#include "condyle/hal/hid/report_descriptor.h"

namespace condyle::hal {

/// A usable profile, or why there is none.
struct DescriptorProfile {
  std::optional<DeviceProfile> profile;
  std::string reason;  ///< only where there is no profile
};

/// `base` with the coordinates of one point added: the usages X, Y and Z of the Generic Desktop
/// page (HID Usage Tables, page 0x01, usages 0x30 to 0x32), each in one absolute field with a unit
/// of length, all in one input report; turned by `base.descriptor_axes`, as they are where it is
/// not set. `base.report_id` chooses among several reports. Raw values outside the logical range
/// say "not measured" (HID 1.11, section 5.10). Refused where the descriptor leaves anything to
/// guess.
DescriptorProfile complete_from_descriptor(const DeviceProfile& base,
                                           const ReportDescriptor& descriptor);

}  // namespace condyle::hal
