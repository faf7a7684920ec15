// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/usb/device_list.h"

#include <linux/input.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>

#include "condyle/hal/hid/report_descriptor.h"

namespace condyle::hal {
namespace {

namespace fs = std::filesystem;

// Length of the UTF-8 character at the start of `text`; 0: it must not be sent to a terminal.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  if (byte(0) < 0x80) return byte(0) >= 0x20 && byte(0) != 0x7F ? 1 : 0;
  const std::size_t length = byte(0) < 0xE0 ? 2 : byte(0) < 0xF0 ? 3 : 4;
  if (byte(0) < 0xC2 || byte(0) > 0xF4) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  }
  const unsigned start = byte(0) << 8U | byte(1);
  // Control characters, overlong forms, surrogates, beyond the last character.
  const bool is_none = (start >= 0xC280 && start < 0xC2A0) || (start >= 0xE080 && start < 0xE0A0) ||
                       (start >= 0xEDA0 && start < 0xEE00) || (start >= 0xF080 && start < 0xF090) ||
                       start >= 0xF490;
  return is_none ? 0 : length;
}

// A device's name may contain anything; it must not control a terminal.
std::string clean(std::string_view text) {
  std::string good;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    good += length > 0 ? text.substr(0, length) : "?";
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return good;
}

DeviceBus bus_of(unsigned type) {
  constexpr unsigned kSpi = 0x1C;  // BUS_SPI of newer kernels
  switch (type) {
    case BUS_USB:
      return DeviceBus::usb;
    case BUS_BLUETOOTH:
      return DeviceBus::bluetooth;
    case BUS_I2C:
      return DeviceBus::i2c;
    case kSpi:
      return DeviceBus::spi;
    default:
      return DeviceBus::unknown;
  }
}

DeviceAccess access_to(const std::string& path) {
  if (access(path.c_str(), R_OK | W_OK) == 0) return DeviceAccess::permitted;
  return access(path.c_str(), F_OK) == 0 ? DeviceAccess::not_permitted : DeviceAccess::not_there;
}

// A device may go away during any of the reading below; what is gone reads as empty.

std::string read_line(const fs::path& file) {
  std::string line;
  std::ifstream stream(file);
  std::getline(stream, line);
  return clean(line);
}

int read_number(const fs::path& file, int base) {
  const std::string line = read_line(file);
  char* end = nullptr;
  const long number = std::strtol(line.c_str(), &end, base);
  return end != line.c_str() ? static_cast<int>(number) : -1;
}

// The folder that contains `file`, from `folder` upwards; empty if there is none.
fs::path find_above(fs::path folder, const char* file) {
  std::error_code error;
  while (folder.has_relative_path() && !fs::exists(folder / file, error)) {
    folder = folder.parent_path();
  }
  return folder.has_relative_path() ? folder : fs::path();
}

// Data of the device from the kernel's HID layer; false if there are none.
bool read_hid_device(const fs::path& folder, HidDevice& device) {
  std::ifstream stream(folder / "uevent");
  unsigned bus = 0, vendor_id = 0, product_id = 0;
  bool is_known = false;
  for (std::string line; std::getline(stream, line);) {
    const std::string_view text = line;
    const std::size_t mark = std::min(text.find('='), text.size());
    const std::string_view name = text.substr(0, mark);
    const std::string_view value = text.substr(std::min(mark + 1, text.size()));
    if (name == "HID_ID") {
      is_known = std::sscanf(line.c_str(), "HID_ID=%x:%x:%x", &bus, &vendor_id, &product_id) == 3;
    } else if (name == "HID_NAME") {
      device.product = clean(value);
    } else if (name == "HID_UNIQ") {
      device.serial = clean(value);
    }
  }
  device.bus = bus_of(bus);
  device.vendor_id = static_cast<std::uint16_t>(vendor_id);
  device.product_id = static_cast<std::uint16_t>(product_id);
  return is_known;
}

// Data of the USB device behind it: .../1-1.4/1-1.4:1.0/0003:1209:0001.0001. A virtual device
// claims to be on USB but has none.
void read_usb_device(const fs::path& folder, HidDevice& device) {
  const fs::path usb = find_above(folder, "devnum");
  if (usb.empty()) return;
  const int bus = read_number(usb / "busnum", 10), number = read_number(usb / "devnum", 10);
  if (bus < 0 || number < 0) return;
  const fs::path interface = find_above(folder, "bInterfaceNumber");
  device.manufacturer = read_line(usb / "manufacturer");
  device.product = read_line(usb / "product");
  if (!interface.empty()) {
    device.interface_number = read_number(interface / "bInterfaceNumber", 16);
  }
  char path[64];
  std::snprintf(path, sizeof path, "/dev/bus/usb/%03d/%03d", bus, number);
  device.usb_port = usb.filename();
  device.usb_path = path;
  device.usb_access = access_to(path);
}

void read_usage(const fs::path& folder, HidDevice& device) {
  std::ifstream file(folder / "report_descriptor", std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file),
                                        std::istreambuf_iterator<char>()};
  const auto descriptor = parse_report_descriptor(bytes).descriptor;
  if (!descriptor || descriptor->applications.empty()) return;
  const std::uint32_t usage = descriptor->applications.front().first;
  device.usage_page = static_cast<std::uint16_t>(usage >> 16U);
  device.usage = static_cast<std::uint16_t>(usage);
}

std::optional<HidDevice> read_device(const fs::path& hidraw) {
  std::error_code error;
  const fs::path folder = fs::canonical(hidraw / "device", error);
  HidDevice device;
  if (error || !read_hid_device(folder, device)) return std::nullopt;
  if (device.bus == DeviceBus::usb) read_usb_device(folder, device);
  read_usage(folder, device);
  device.path = fs::path("/dev") / hidraw.filename();
  device.access = access_to(device.path);
  return device;
}

}  // namespace

// hidapi's own list is not used: hidapi 0.13 ends the program if any HID device goes away while it
// is being listed (the uevent file disappears before the node, and its length is used unchecked).
std::vector<HidDevice> list_hid_devices(std::uint16_t vendor_id, std::uint16_t product_id,
                                        const fs::path& hidraw_class) {
  std::vector<fs::path> nodes;
  std::error_code error;
  for (fs::directory_iterator entry(hidraw_class, error), end; !error && entry != end;
       entry.increment(error)) {
    nodes.push_back(entry->path());
  }
  std::sort(nodes.begin(), nodes.end(), [](const fs::path& a, const fs::path& b) {
    const auto& first = a.native();
    const auto& second = b.native();  // hidraw2 before hidraw10
    return first.size() != second.size() ? first.size() < second.size() : first < second;
  });
  std::vector<HidDevice> devices;
  for (const fs::path& node : nodes) {
    std::optional<HidDevice> device = read_device(node);
    if (!device || (vendor_id != 0 && device->vendor_id != vendor_id)) continue;
    if (product_id != 0 && device->product_id != product_id) continue;
    devices.push_back(*std::move(device));
  }
  return devices;
}

bool fits(const DeviceAddress& address, const HidDevice& device) {
  // Devices that are not on USB have no interfaces to choose from.
  const bool is_interface = address.interface_number < 0 || device.interface_number < 0 ||
                            address.interface_number == device.interface_number;
  return address.vendor_id == device.vendor_id && address.product_id == device.product_id &&
         is_interface && (address.serial.empty() || address.serial == device.serial) &&
         (address.path.empty() || address.path == device.path || address.path == device.usb_port);
}

}  // namespace condyle::hal
