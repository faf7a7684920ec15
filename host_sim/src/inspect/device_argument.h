// SPDX-License-Identifier: Apache-2.0
// The devices that are plugged in, as text, and the choice of one by the user.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "condyle/hal/clock.h"
#include "condyle/hal/usb/device_list.h"

namespace condyle::host {

/// Usage of the device's first collection, page << 16 | id.
constexpr std::uint32_t device_usage(const hal::HidDevice& device) {
  return std::uint32_t{device.usage_page} << 16U | device.usage;
}

/// "046d:c626 3Dconnexion SpaceNavigator".
std::string name_text(const hal::HidDevice& device);

/// The devices with their places and permissions, a few lines each.
std::string devices_text(std::span<const hal::HidDevice> devices);
/// The same as JSON.
nlohmann::ordered_json devices_json(std::span<const hal::HidDevice> devices);

/// The address of the one of `devices` that `text` names: "046d:c626", "/dev/hidraw0" or a USB
/// port, "1-1.4"; of several with the same ids the one with this serial number, if it is not empty;
/// of one device's interfaces the first with vendor-defined usages, otherwise the first. Nothing if
/// there is none; throws InputError if there is more than one.
std::optional<hal::DeviceAddress> find_device(const std::string& text, const std::string& serial,
                                              std::span<const hal::HidDevice> devices);

/// The same among the devices that are plugged in. Ids always give an address: the device may
/// appear later, or be visible to libusb only. For other texts it waits up to 2 s or until `stop`;
/// throws InputError if there is no such device.
hal::DeviceAddress wait_for_device(const std::string& text, const std::string& serial,
                                   hal::Clock& clock, const std::function<bool()>& stop);

}  // namespace condyle::host
