// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace condyle::hal {

/// Selects a device: the first that matches all of these.
struct DeviceAddress {
  std::uint16_t vendor_id = 0, product_id = 0;
  int interface_number = -1;  ///< -1: the first HID interface; for USB devices
  std::string serial;         ///< empty: any device
  /// Its place: "/dev/hidraw3" (hidapi only), or its USB port, "1-1.4", which distinguishes devices
  /// without serial number; empty: anywhere.
  std::string path;
};

}  // namespace condyle::hal
