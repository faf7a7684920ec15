// SPDX-License-Identifier: Apache-2.0
// The udev rule that allows users and the box to read a device, with the least rights.
#pragma once

#include <string>
#include <vector>

#include "condyle/hal/usb/device_list.h"

namespace condyle::host {

/// The driver that reads the device.
enum class DeviceBackEnd : std::uint8_t {
  hidapi,  ///< the kernel's driver: only its reports
  libusb,  ///< takes the whole device
};

/// The file in /etc/udev/rules.d, one for each model of device, so that rules do not hide each
/// other.
std::string udev_rule_file(const hal::HidDevice& device);

/// The rule for `device`: for the reports of one interface if `others` contains more of the same
/// device, otherwise for all its reports.
std::string udev_rule(const hal::HidDevice& device, DeviceBackEnd back_end,
                      const std::vector<hal::HidDevice>& others);

}  // namespace condyle::host
