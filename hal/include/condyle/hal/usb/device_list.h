// SPDX-License-Identifier: Apache-2.0
// Lists the HID devices that are plugged in, without opening them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "condyle/hal/usb/device_address.h"

namespace condyle::hal {

/// How a device is connected.
enum class DeviceBus : std::uint8_t { unknown, usb, bluetooth, i2c, spi };

/// Name of a bus in messages.
constexpr const char* bus_name(DeviceBus bus) {
  constexpr const char* names[] = {"unknown bus", "USB", "Bluetooth", "I2C", "SPI"};
  return names[static_cast<int>(bus)];
}

/// Whether this process may use a device file.
enum class DeviceAccess : std::uint8_t {
  permitted,
  not_permitted,  ///< access is denied: see hal/udev
  not_there,      ///< there is no such file
};

/// Name of an access in messages.
constexpr const char* access_name(DeviceAccess access) {
  constexpr const char* names[] = {"permitted", "not permitted", "not there"};
  return names[static_cast<int>(access)];
}

/// A HID interface of a device. Texts are UTF-8, empty if the device has none.
struct HidDevice {
  std::uint16_t vendor_id = 0, product_id = 0;
  std::uint16_t usage_page = 0, usage = 0;  ///< of its first collection
  std::string manufacturer, product, serial;
  int interface_number = -1;  ///< -1: not on USB
  DeviceBus bus = DeviceBus::unknown;
  std::string path;                                   ///< "/dev/hidraw3": HidapiSource
  DeviceAccess access = DeviceAccess::not_there;      ///< to `path`
  std::string usb_port;                               ///< "1-1.4"; empty: not on USB
  std::string usb_path;                               ///< "/dev/bus/usb/001/004": LibusbSource
  DeviceAccess usb_access = DeviceAccess::not_there;  ///< to `usb_path`
};

/// The HID devices, in the order of their nodes; 0: any vendor or product. A device that is being
/// plugged in or unplugged may be missing. `hidraw_class`: folder of sysfs that lists them.
/// Allocates.
std::vector<HidDevice> list_hid_devices(
    std::uint16_t vendor_id = 0, std::uint16_t product_id = 0,
    const std::filesystem::path& hidraw_class = "/sys/class/hidraw");

/// Whether `address` matches this device.
bool fits(const DeviceAddress& address, const HidDevice& device);

}  // namespace condyle::hal
