// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace condyle::hal {

/// Which device is meant: the first that all of this fits.
struct DeviceAddress {
  std::uint16_t vendor_id = 0, product_id = 0;
  int interface_number = -1;  ///< -1: the first HID interface; of a USB device
  std::string serial;         ///< empty: any
  /// Where it is, "/dev/hidraw3" (hidapi only), or the USB port it is plugged into, "1-1.4", which
  /// tells devices without serial number apart; empty: anywhere.
  std::string path;
};

}  // namespace condyle::hal
