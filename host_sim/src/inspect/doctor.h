// SPDX-License-Identifier: Apache-2.0
// Checks whether a computer can read a facebow, and gives the remedy for each problem.
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
  optional,  ///< an optional component is missing
  missing,   ///< a device cannot be read
};

/// The result of one check.
struct Finding {
  Severity severity = Severity::fine;
  std::string what;
  std::string mend;  ///< commands or instructions; empty if none are needed
};

/// The examined computer. `this_machine` describes the present one.
struct Machine {
  std::filesystem::path root = "/";  ///< of the file system
  std::string user;
  std::set<std::string> groups;  ///< of the user, in this login
  std::vector<hal::HidDevice> devices;
};
Machine this_machine();

/// `wanted`: the device to read; without one, all devices except keyboards, mice and consumer
/// controls are checked. `back_end`: the driver for it.
std::vector<Finding> examine(const Machine& machine,
                             const std::optional<hal::DeviceAddress>& wanted,
                             DeviceBackEnd back_end = DeviceBackEnd::hidapi);

/// The device of a new rule: the one that is plugged in, otherwise any of that model on USB.
hal::HidDevice device_for_rule(const Machine& machine, const hal::DeviceAddress& wanted);

/// The findings as text, with the remedies indented below them.
std::string findings_text(const std::vector<Finding>& findings);

}  // namespace condyle::host
