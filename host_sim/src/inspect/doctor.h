// SPDX-License-Identifier: Apache-2.0
// What a computer lacks to read a facebow, and the command that mends it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "condyle/hal/usb/device_list.h"
#include "inspect/udev_rule.h"

namespace condyle::host {

/// How bad a finding is.
enum class Severity : std::uint8_t {
  fine,
  optional,  ///< something that not everybody needs is missing
  missing,   ///< a device cannot be read
};

/// One thing looked at.
struct Finding {
  Severity severity = Severity::fine;
  std::string what;
  std::string mend;  ///< commands, or what to do; empty if nothing is to be done
};

/// What is examined. `this_machine` fills it in.
struct Machine {
  std::filesystem::path root = "/";  ///< of the file system
  std::string user;
  std::set<std::string> groups;  ///< of the user, in this login
  std::vector<hal::HidDevice> devices;
};
Machine this_machine();

/// `wanted`: the device that is to be read; without one all but keyboards, mice and consumer
/// controls are looked at. `back_end`: what is to read it.
std::vector<Finding> examine(const Machine& machine,
                             const std::optional<hal::DeviceAddress>& wanted,
                             DeviceBackEnd back_end = DeviceBackEnd::hidapi);

/// The device that a rule is made for: as it is plugged in, else any of that model on USB.
hal::HidDevice device_for_rule(const Machine& machine, const hal::DeviceAddress& wanted);

/// The findings as text, the mends indented under them.
std::string findings_words(const std::vector<Finding>& findings);

}  // namespace condyle::host
