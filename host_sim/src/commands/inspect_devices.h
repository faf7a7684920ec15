// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace condyle::host {

/// The options of `condyle inspect`.
struct InspectOptions {
  std::string descriptor, device, profile, serial;
  std::string backend = "hidapi";
  double duration_s = 3;
  bool as_json = false;
};

/// Prints the HID devices that are plugged in; returns the exit code.
int list_devices(const InspectOptions& options);

/// Prints what a device sends; returns the exit code.
int inspect_device(const InspectOptions& options);

}  // namespace condyle::host
