// SPDX-License-Identifier: Apache-2.0
// The rule with which udev lets users and the box read a device, with the least rights.
#pragma once

#include <string>
#include <vector>

#include "condyle/hal/usb/device_list.h"

namespace condyle::host {

/// What reads the device.
enum class DeviceBackEnd : std::uint8_t {
  hidapi,  ///< the kernel's driver: its reports alone
  libusb,  ///< takes the whole device
};

/// The file in /etc/udev/rules.d, one for each model of device, so that none hides another.
std::string udev_rule_file(const hal::HidDevice& device);

/// The rule for `device`: of the reports of one interface where `others` has more of the same
/// device, of all its reports elsewhere.
std::string udev_rule(const hal::HidDevice& device, DeviceBackEnd back_end,
                      const std::vector<hal::HidDevice>& others);

}  // namespace condyle::host
