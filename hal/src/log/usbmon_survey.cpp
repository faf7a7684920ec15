// SPDX-License-Identifier: Apache-2.0
#include "log/usbmon_survey.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace condyle::hal {
namespace {

constexpr std::size_t kMaxEndpoints = 256, kMaxDevices = 1024;
// USB 2.0, 9.4.3 and 9.6.1: GET_DESCRIPTOR(DEVICE), and the descriptor's size and fields.
constexpr std::array<std::uint8_t, 4> kGetDeviceDescriptor = {0x80, 6, 0, 1};
constexpr std::size_t kDescriptorSize = 18, kVendorAt = 8, kProductAt = 10;

std::uint16_t number_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

template <typename Number>
bool fits(const std::optional<Number>& wanted, Number found) {
  return !wanted || *wanted == found;
}

bool is_named(const UsbmonEndpoint& endpoint) {
  return endpoint.vendor_id.has_value();
}

bool has_wanted_name(const UsbmonEndpoint& endpoint, const UsbmonChoice& choice) {
  return is_named(endpoint) && fits(choice.vendor_id, *endpoint.vendor_id) &&
         fits(choice.product_id, *endpoint.product_id);
}

// One device with one endpoint, at successive addresses.
bool is_one_device(const std::vector<UsbmonEndpoint>& endpoints) {
  for (std::size_t i = 1; i < endpoints.size(); ++i) {
    const UsbmonEndpoint &before = endpoints[i - 1], &after = endpoints[i];
    if (!is_named(before) || before.vendor_id != after.vendor_id ||
        before.product_id != after.product_id || before.endpoint != after.endpoint ||
        before.last_packet >= after.first_packet) {
      return false;
    }
  }
  return !endpoints.empty();
}

std::string list(const std::vector<UsbmonEndpoint>& endpoints) {
  if (endpoints.empty()) return "no interrupt-IN endpoint sends data in the capture";
  std::string text = "endpoints that send reports:";
  for (const UsbmonEndpoint& endpoint : endpoints) {
    char name[16] = "ids unknown";
    if (is_named(endpoint)) {
      std::snprintf(name, sizeof(name), "%04x:%04x", *endpoint.vendor_id, *endpoint.product_id);
    }
    text += "\n  bus " + std::to_string(endpoint.bus) + " device " +
            std::to_string(endpoint.device) + " endpoint " + std::to_string(endpoint.endpoint) +
            " (" + name + "): " + std::to_string(endpoint.reports) + " reports";
    if (endpoint.cut_reports > 0) {
      text += ", " + std::to_string(endpoint.cut_reports) + " cut short by the capture";
    }
  }
  return text;
}

}  // namespace

void UsbmonSurvey::add(const UsbmonPacket& packet) {
  if (packet.transfer_type == kControlTransfer) add_control(packet);
  if (packet.transfer_type == kInterruptTransfer && packet.event == 'C' && packet.status == 0 &&
      (packet.endpoint & 0x80U) != 0 && packet.length > 0) {
    add_report(packet);
  }
}

void UsbmonSurvey::add_control(const UsbmonPacket& packet) {
  if (packet.device == 0) return;  // not yet addressed
  const Address address{packet.bus, packet.device};
  if (packet.event == 'S') {
    const bool asks =
        packet.has_setup && std::equal(kGetDeviceDescriptor.begin(), kGetDeviceDescriptor.end(),
                                       std::begin(packet.setup));
    if (!asks) return;
    if (devices_.size() >= kMaxDevices && devices_.count(address) == 0) {
      has_overflowed_ = true;
      return;
    }
    devices_[address].asked_id = packet.id;
    return;
  }
  const auto found = devices_.find(address);
  if (found == devices_.end() || found->second.asked_id != packet.id) return;
  Device& device = found->second;
  device.asked_id.reset();
  if (packet.event != 'C' || packet.status != 0 || packet.data.size() < kDescriptorSize ||
      packet.data[0] != kDescriptorSize || packet.data[1] != 1) {
    return;
  }
  const std::uint16_t vendor_id = number_at(packet.data, kVendorAt);
  const std::uint16_t product_id = number_at(packet.data, kProductAt);
  const bool is_another =
      device.vendor_id && (*device.vendor_id != vendor_id || *device.product_id != product_id);
  if (is_another) device.first_endpoint = endpoints_.size();
  device.vendor_id = vendor_id;
  device.product_id = product_id;
  // The first descriptor also identifies the reports before it.
  for (std::size_t i = device.first_endpoint; i < endpoints_.size(); ++i) {
    if (endpoints_[i].bus != packet.bus || endpoints_[i].device != packet.device) continue;
    endpoints_[i].vendor_id = vendor_id;
    endpoints_[i].product_id = product_id;
  }
}

void UsbmonSurvey::add_report(const UsbmonPacket& packet) {
  const auto number = static_cast<std::uint8_t>(packet.endpoint & 0x0fU);
  const auto device = devices_.find({packet.bus, packet.device});
  const bool is_known = device != devices_.end();
  const auto begin = static_cast<std::ptrdiff_t>(is_known ? device->second.first_endpoint : 0);
  auto endpoint =
      std::find_if(endpoints_.begin() + begin, endpoints_.end(), [&](const UsbmonEndpoint& other) {
        return other.bus == packet.bus && other.device == packet.device && other.endpoint == number;
      });
  if (endpoint == endpoints_.end()) {
    if (endpoints_.size() >= kMaxEndpoints) {
      has_overflowed_ = true;
      return;
    }
    UsbmonEndpoint added{.bus = packet.bus, .device = packet.device, .endpoint = number};
    if (is_known) {
      added.vendor_id = device->second.vendor_id;
      added.product_id = device->second.product_id;
    }
    added.first_packet = packet.number;
    endpoint = endpoints_.insert(endpoints_.end(), added);
  }
  ++(packet.is_cut ? endpoint->cut_reports : endpoint->reports);
  endpoint->last_packet = packet.number;
}

Status choose_endpoint(const std::vector<UsbmonEndpoint>& endpoints, const UsbmonChoice& choice,
                       std::vector<UsbmonEndpoint>& chosen, std::string& problem) {
  chosen.clear();
  const auto add_where = [&](auto condition) {
    for (const UsbmonEndpoint& endpoint : endpoints) {
      const bool is_at_address = fits(choice.bus, endpoint.bus) &&
                                 fits(choice.device, endpoint.device) &&
                                 fits(choice.endpoint, endpoint.endpoint);
      if (is_at_address && condition(endpoint)) chosen.push_back(endpoint);
    }
  };
  const bool names = choice.vendor_id || choice.product_id;
  if (names) {
    add_where([&](const UsbmonEndpoint& endpoint) { return has_wanted_name(endpoint, choice); });
    // A capture that began after the device was plugged in lacks its ids.
    if (chosen.empty())
      add_where([](const UsbmonEndpoint& endpoint) { return !is_named(endpoint); });
  } else {
    add_where([](const UsbmonEndpoint&) { return true; });
  }
  if (chosen.empty()) {
    problem = "no endpoint matches the request; " + list(endpoints);
    return Status::not_found;
  }
  if (chosen.size() > 1 && !is_one_device(chosen)) {
    problem = "more than one endpoint matches; name bus, device and endpoint; " + list(chosen);
    return Status::bad_report;
  }
  const bool has_reports = std::any_of(chosen.begin(), chosen.end(),
                                       [](const UsbmonEndpoint& one) { return one.reports > 0; });
  if (!has_reports) {
    problem = "every report was cut short by the capture: capture without a snapshot length; " +
              list(chosen);
    return Status::bad_report;
  }
  return Status::ok;
}

}  // namespace condyle::hal
