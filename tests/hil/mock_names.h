// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/mock_node.h"

namespace condyle::hil {

/// The fake facebow, plugged in for the `plug`th time (from 0), as hidraw shows it: with the USB
/// device, interface and HID device above.
MockNames hidraw_names(unsigned plug, const std::string& serial);
/// The same as usbfs shows it.
MockNames usbfs_names(unsigned plug);

}  // namespace condyle::hil
