// SPDX-License-Identifier: Apache-2.0
#include "inspect/udev_rule.h"

#include <fmt/format.h>

#include <algorithm>

namespace condyle::host {
namespace {

constexpr const char* kRights = R"(MODE="0660", GROUP="plugdev", TAG+="uaccess")";

// linux/input.h numbers the buses.
int bus_number(hal::DeviceBus bus) {
  switch (bus) {
    case hal::DeviceBus::bluetooth:
      return 0x0005;
    case hal::DeviceBus::i2c:
      return 0x0018;
    case hal::DeviceBus::spi:
      return 0x001C;
    case hal::DeviceBus::usb:
    case hal::DeviceBus::unknown:
      break;
  }
  return 0x0003;
}

bool has_other_interfaces(const hal::HidDevice& device, const std::vector<hal::HidDevice>& others) {
  return std::any_of(others.begin(), others.end(), [&](const hal::HidDevice& other) {
    return other.vendor_id == device.vendor_id && other.product_id == device.product_id &&
           other.usb_port == device.usb_port && other.interface_number >= 0 &&
           other.interface_number != device.interface_number;
  });
}

}  // namespace

std::string udev_rule_file(const hal::HidDevice& device) {
  return fmt::format("/etc/udev/rules.d/70-condyle-{:04x}-{:04x}.rules", device.vendor_id,
                     device.product_id);
}

// As in hal/udev/70-condyle-facebow.rules.
std::string udev_rule(const hal::HidDevice& device, DeviceBackEnd back_end,
                      const std::vector<hal::HidDevice>& others) {
  if (back_end == DeviceBackEnd::libusb) {
    return fmt::format(R"(SUBSYSTEM=="usb", ENV{{DEVTYPE}}=="usb_device", )"
                       R"(ATTR{{idVendor}}=="{:04x}", ATTR{{idProduct}}=="{:04x}", {})",
                       device.vendor_id, device.product_id, kRights);
  }
  // On other buses the name of the kernel's device contains the ids.
  if (device.bus != hal::DeviceBus::usb) {
    return fmt::format(R"(SUBSYSTEM=="hidraw", KERNELS=="{:04X}:{:04X}:{:04X}.*", {})",
                       bus_number(device.bus), device.vendor_id, device.product_id, kRights);
  }
  if (device.interface_number >= 0 && has_other_interfaces(device, others)) {
    return fmt::format(
        R"(SUBSYSTEM=="hidraw", ATTRS{{modalias}}=="usb:v{:04X}p{:04X}*in{:02X}", {})",
        device.vendor_id, device.product_id, device.interface_number, kRights);
  }
  return fmt::format(
      R"(SUBSYSTEM=="hidraw", ATTRS{{idVendor}}=="{:04x}", ATTRS{{idProduct}}=="{:04x}", {})",
      device.vendor_id, device.product_id, kRights);
}

}  // namespace condyle::host
