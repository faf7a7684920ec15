// SPDX-License-Identifier: Apache-2.0
#include "hil/mock_names.h"

#include <fmt/format.h>

#include <span>

#include "fake/facebow_usb.h"

namespace condyle::hil {
namespace {

using namespace host::fake;

constexpr const char* kDevicePath = "/devices/pci0000:00/0000:00:14.0/usb1/1-1";

std::string hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{:02X}", byte);
  return text;
}

// USB numbers its devices from 1 to 127; the root hub is 1.
unsigned device_number(unsigned plug) {
  return 2 + plug % 126;
}

std::string usbfs_node(unsigned plug) {
  return fmt::format("/dev/bus/usb/001/{:03}", device_number(plug));
}

void add(MockNames& names, const std::string& path, const std::string& description) {
  names.paths.push_back(path);
  names.devices.push_back(fmt::format("P: {}\n{}\n", path, description));
}

void add_usb(MockNames& names, unsigned plug, std::string_view serial) {
  const unsigned number = device_number(plug);
  add(names, kDevicePath,
      fmt::format("E: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DRIVER=usb\nE: DEVNAME={}\n"
                  "E: BUSNUM=001\nE: DEVNUM={:03}\nE: MAJOR=189\nE: MINOR={}\n"
                  "A: busnum=1\\n\nA: devnum={}\\n\nA: dev=189:{}\\n\nA: speed=12\\n\n"
                  "A: idVendor={:04x}\\n\nA: idProduct={:04x}\\n\nA: bcdDevice={:04x}\\n\n"
                  "A: bConfigurationValue=1\\n\nA: bNumInterfaces= 1\\n\n"
                  "A: manufacturer={}\\n\nA: product={}\\n\nA: serial={}\\n\n"
                  "H: descriptors={}{}\n",
                  usbfs_node(plug), number, number - 1, number, number - 1, kVendorId, kProductId,
                  kDeviceVersion, kManufacturer, kProduct, serial, hex(device_descriptor()),
                  hex(configuration_descriptor())));
  add(names, fmt::format("{}/1-1:1.0", kDevicePath),
      "E: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nA: bInterfaceNumber=00\\n\n"
      "A: bInterfaceClass=03\\n\n");
}

}  // namespace

MockNames usbfs_names(unsigned plug) {
  MockNames names;
  names.node = usbfs_node(plug);
  add_usb(names, plug, kSerial);
  return names;
}

MockNames hidraw_names(unsigned plug, const std::string& serial) {
  MockNames names;
  names.node = fmt::format("/dev/hidraw{}", plug);
  add_usb(names, plug, serial);
  const std::string hid = fmt::format("0003:{:04X}:{:04X}.{:04X}", kVendorId, kProductId, plug + 1);
  const std::string hid_path = names.paths.back() + "/" + hid;
  names.identity = hid_path + "/uevent";
  add(names, hid_path,
      fmt::format("E: SUBSYSTEM=hid\nE: DRIVER=hid-generic\nE: HID_ID=0003:{:08X}:{:08X}\n"
                  "E: HID_NAME={} {}\nE: HID_PHYS=usb-0000:00:14.0-1/input0\nE: HID_UNIQ={}\n"
                  "H: report_descriptor={}\n",
                  kVendorId, kProductId, kManufacturer, kProduct, serial,
                  hex(report_descriptor())));
  add(names, fmt::format("{}/hidraw/hidraw{}", hid_path, plug),
      fmt::format("E: SUBSYSTEM=hidraw\nE: DEVNAME={}\nE: MAJOR=240\nE: MINOR={}\n"
                  "A: dev=240:{}\\n\nL: device=../../../{}\n",
                  names.node, plug, plug, hid));
  return names;
}

}  // namespace condyle::hil
