// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/device_list.h"

#include <hidapi.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "hidapi_lock.h"

namespace condyle::hal {
namespace {

namespace fs = std::filesystem;

// hidapi's texts are code points.
std::string to_utf8(const wchar_t* text) {
  std::string bytes;
  for (; text != nullptr && *text != 0; ++text) {
    auto point = static_cast<std::uint32_t>(*text);
    if (point < 0x20 || (point >= 0x7F && point < 0xA0)) point = '?';  // no terminal may obey it
    if (point < 0x80) {
      bytes += static_cast<char>(point);
      continue;
    }
    const unsigned following = point < 0x800 ? 1 : point < 0x10000 ? 2 : 3;
    constexpr std::uint32_t kMarks[] = {0, 0xC0, 0xE0, 0xF0};
    bytes += static_cast<char>(kMarks[following] | point >> 6 * following);
    for (unsigned i = following; i-- > 0;) {
      bytes += static_cast<char>(0x80U | (point >> 6 * i & 0x3FU));
    }
  }
  return bytes;
}

DeviceBus bus_of(hid_bus_type type) {
  switch (type) {
    case HID_API_BUS_USB:
      return DeviceBus::usb;
    case HID_API_BUS_BLUETOOTH:
      return DeviceBus::bluetooth;
    case HID_API_BUS_I2C:
      return DeviceBus::i2c;
    case HID_API_BUS_SPI:
      return DeviceBus::spi;
    case HID_API_BUS_UNKNOWN:
      break;
  }
  return DeviceBus::unknown;
}

DeviceAccess access_to(const std::string& path) {
  if (access(path.c_str(), R_OK | W_OK) == 0) return DeviceAccess::permitted;
  return access(path.c_str(), F_OK) == 0 ? DeviceAccess::not_permitted : DeviceAccess::not_there;
}

int read_number(const fs::path& file) {
  int number = -1;
  std::ifstream(file) >> number;
  return number;
}

// The USB device behind a hidraw node, by the folders sysfs keeps it in: .../1-1.4/1-1.4:1.0/...
void find_usb_device(HidDevice& device) {
  std::error_code error;
  const fs::path hidraw = fs::path("/sys/class/hidraw") / fs::path(device.path).filename();
  fs::path folder = fs::canonical(hidraw / "device", error);
  while (!error && folder.has_relative_path() && !fs::exists(folder / "devnum", error)) {
    folder = folder.parent_path();
  }
  const int bus = read_number(folder / "busnum"), number = read_number(folder / "devnum");
  if (bus < 0 || number < 0) return;
  char path[64];
  std::snprintf(path, sizeof path, "/dev/bus/usb/%03d/%03d", bus, number);
  device.usb_port = folder.filename();
  device.usb_path = path;
  device.usb_access = access_to(path);
}

}  // namespace

std::vector<HidDevice> list_hid_devices(std::uint16_t vendor_id, std::uint16_t product_id) {
  std::vector<HidDevice> devices;
  const std::lock_guard lock(hidapi_mutex());
  hid_device_info* const list = hid_enumerate(vendor_id, product_id);
  for (const hid_device_info* info = list; info != nullptr; info = info->next) {
    if (info->path == nullptr) continue;  // it went away while the list was made
    // hidapi repeats a device for each of its collections.
    if (!devices.empty() && devices.back().path == info->path) continue;
    HidDevice& device = devices.emplace_back();
    device.vendor_id = info->vendor_id;
    device.product_id = info->product_id;
    device.usage_page = info->usage_page;
    device.usage = info->usage;
    device.manufacturer = to_utf8(info->manufacturer_string);
    device.product = to_utf8(info->product_string);
    device.serial = to_utf8(info->serial_number);
    device.bus = bus_of(info->bus_type);
    device.interface_number = device.bus == DeviceBus::usb ? info->interface_number : -1;
    device.path = info->path;
    device.access = access_to(device.path);
    if (device.bus == DeviceBus::usb) find_usb_device(device);
  }
  hid_free_enumeration(list);
  return devices;
}

bool fits(const DeviceAddress& address, const HidDevice& device) {
  // What is not on USB has no interfaces to choose from.
  const bool is_interface = address.interface_number < 0 || device.interface_number < 0 ||
                            address.interface_number == device.interface_number;
  return address.vendor_id == device.vendor_id && address.product_id == device.product_id &&
         is_interface && (address.serial.empty() || address.serial == device.serial) &&
         (address.path.empty() || address.path == device.path || address.path == device.usb_port);
}

}  // namespace condyle::hal
