// SPDX-License-Identifier: Apache-2.0
#include "inspect/device_argument.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <utility>
#include <vector>

#include "hosted/devices/connected_device.h"
#include "hosted/files/input_error.h"
#include "inspect/descriptor_text.h"

namespace condyle::host {
namespace {

// "1209:0001".
std::optional<std::pair<std::uint16_t, std::uint16_t>> read_ids(const std::string& text) {
  std::uint16_t vendor_id = 0, product_id = 0;
  const char* const begin = text.data();
  if (text.size() != 9 || text[4] != ':') return std::nullopt;
  const auto vendor = std::from_chars(begin, begin + 4, vendor_id, 16);
  const auto product = std::from_chars(begin + 5, begin + 9, product_id, 16);
  if (vendor.ptr != begin + 4 || product.ptr != begin + 9) return std::nullopt;
  return std::pair(vendor_id, product_id);
}

std::string place_text(const std::string& path, hal::DeviceAccess access) {
  return fmt::format("{} ({})", path, hal::access_name(access));
}

}  // namespace

std::string name_text(const hal::HidDevice& device) {
  std::string text = id_text(device.vendor_id, device.product_id);
  for (const std::string& part : {device.manufacturer, device.product}) {
    if (!part.empty()) text += " " + part;
  }
  return text;
}

std::string devices_text(std::span<const hal::HidDevice> devices) {
  std::string text;
  for (const hal::HidDevice& device : devices) {
    text += name_text(device) + '\n';
    const std::uint32_t usage = device_usage(device);
    text +=
        fmt::format("  is        {}, on {}", usage_text({usage, usage}), hal::bus_name(device.bus));
    if (device.interface_number >= 0)
      text += fmt::format(", interface {}", device.interface_number);
    if (!device.serial.empty()) text += ", serial number " + device.serial;
    text += "\n  hidapi    " + place_text(device.path, device.access) + '\n';
    if (!device.usb_path.empty()) {
      text += fmt::format("  libusb    {}, USB port {}\n",
                          place_text(device.usb_path, device.usb_access), device.usb_port);
    }
  }
  return text;
}

nlohmann::ordered_json devices_json(std::span<const hal::HidDevice> devices) {
  auto json = nlohmann::ordered_json::array();
  for (const hal::HidDevice& device : devices) {
    json.push_back({{"vendor_id", device.vendor_id},
                    {"product_id", device.product_id},
                    {"manufacturer", device.manufacturer},
                    {"product", device.product},
                    {"serial", device.serial},
                    {"usage_page", device.usage_page},
                    {"usage", device.usage},
                    {"bus", hal::bus_name(device.bus)},
                    {"interface", device.interface_number},
                    {"hidraw_path", device.path},
                    {"hidraw_access", hal::access_name(device.access)},
                    {"usb_port", device.usb_port},
                    {"usb_path", device.usb_path},
                    {"usb_access", hal::access_name(device.usb_access)}});
  }
  return json;
}

std::optional<hal::DeviceAddress> find_device(const std::string& text, const std::string& serial,
                                              std::span<const hal::HidDevice> devices) {
  const auto ids = read_ids(text);
  std::vector<const hal::HidDevice*> found;
  for (const hal::HidDevice& device : devices) {
    const bool is_named =
        (ids && ids->first == device.vendor_id && ids->second == device.product_id) ||
        text == device.path || text == device.usb_port;
    if (is_named && (serial.empty() || serial == device.serial)) found.push_back(&device);
  }
  if (found.empty()) return std::nullopt;
  // Interfaces of one device count as one. Measuring devices send on vendor-defined usages; their
  // other interfaces may be a keyboard for buttons.
  const auto is_vendor_defined = [](const hal::HidDevice* device) {
    return device->usage_page >= 0xFF00;
  };
  const auto chosen = std::find_if(found.begin(), found.end(), is_vendor_defined);
  const hal::HidDevice& first = chosen != found.end() ? **chosen : *found.front();
  const bool are_one = std::all_of(found.begin(), found.end(), [&](const hal::HidDevice* device) {
    return !device->usb_port.empty() && device->usb_port == first.usb_port;
  });
  if (found.size() > 1 && !are_one) {
    std::string places;
    for (const hal::HidDevice* device : found) {
      places += (places.empty() ? "" : ", ") + device->path;
    }
    throw InputError("device " + text, "is plugged in more than once", "give one of " + places);
  }
  return hal::DeviceAddress{.vendor_id = first.vendor_id,
                            .product_id = first.product_id,
                            .interface_number = first.interface_number,
                            .serial = serial,
                            .path = first.usb_port.empty() ? first.path : first.usb_port};
}

hal::DeviceAddress wait_for_device(const std::string& text, const std::string& serial,
                                   hal::Clock& clock, const std::function<bool()>& stop) {
  constexpr TimeNs kPatience_ns = 2'000'000'000, kPause_ns = 20'000'000;
  const TimeNs deadline_ns = clock.now_ns() + kPatience_ns;
  const auto ids = read_ids(text);
  for (;;) {
    if (const auto address = find_device(text, serial, hal::list_hid_devices())) return *address;
    if (ids || clock.now_ns() >= deadline_ns || stop()) break;
    clock.sleep_until(clock.now_ns() + kPause_ns);
  }
  // It may not be HID, or have no driver: only libusb sees it then.
  if (ids) return {ids->first, ids->second, -1, serial, {}};
  throw InputError("device " + text, "is not plugged in",
                   "run condyle inspect for a list; write 1209:0001, /dev/hidraw0 or 1-1.4");
}

}  // namespace condyle::host
