// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace condyle::hal {

/// Which device is meant.
struct DeviceAddress {
  std::uint16_t vendor_id = 0, product_id = 0;
  int interface_number = -1;  ///< -1: the first HID interface
  std::string serial;         ///< empty: any
};

}  // namespace condyle::hal
