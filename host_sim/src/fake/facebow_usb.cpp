// SPDX-License-Identifier: Apache-2.0
#include "fake/facebow_usb.h"

#include <algorithm>

namespace condyle::host::fake {
namespace {

using Bytes = std::vector<std::uint8_t>;

// clang-format off
constexpr std::uint8_t kReportDescriptor[] = {
    0x06, 0x00, 0xff,  // usage page: vendor-defined 0xff00
    0x09, 0x01,        // usage 1
    0xa1, 0x01,        // collection: application
    0x85, 0x01,        //   report id 1
    0x09, 0x02,        //   usage 2
    0x15, 0x00,        //   logical minimum 0
    0x26, 0xff, 0x00,  //   logical maximum 255
    0x75, 0x08,        //   report size 8 bits
    0x95, 28,          //   report count
    0x81, 0x02,        //   input: data, variable, absolute
    0xc0};             // end of collection

constexpr std::uint8_t kDeviceDescriptor[] = {
    18, 0x01,                             // length, type
    0x00, 0x02,                           // USB 2.0
    0, 0, 0,                              // class, subclass, protocol: of the interface
    64,                                   // largest packet of endpoint 0
    kVendorId & 0xff, kVendorId >> 8,
    kProductId & 0xff, kProductId >> 8,
    kDeviceVersion & 0xff, kDeviceVersion >> 8,
    1, 2, 3,                              // strings: manufacturer, product, serial
    1};                                   // configurations

constexpr std::uint8_t kConfigurationDescriptor[] = {
    9, 0x02, 34, 0, 1, 1, 0, 0xc0, 50,    // one interface, self-powered, 100 mA
    9, 0x04, 0, 0, 1, 0x03, 0, 0, 0,      // interface 0: one endpoint, HID
    9, 0x21, 0x11, 0x01, 0, 1, 0x22, sizeof kReportDescriptor, 0,  // HID 1.11, report descriptor
    7, 0x05, kEndpoint, 0x03, kLargestPacket, 0, 1};               // interrupt IN, every ms
// clang-format on

constexpr std::uint8_t kEndpointHalt = 0;

enum Request : std::uint8_t {
  kGetStatus = 0,
  kClearFeature = 1,
  kGetDescriptor = 6,
  kGetConfiguration = 8,
  kGetInterface = 10,
};

Bytes copy(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}

Bytes string_descriptor(std::string_view text) {
  Bytes bytes = {static_cast<std::uint8_t>(2 + 2 * text.size()), 0x03};
  for (const char c : text) {
    bytes.push_back(static_cast<std::uint8_t>(c));  // ASCII as UTF-16
    bytes.push_back(0);
  }
  return bytes;
}

// Empty if there is none.
Bytes descriptor(const ControlRequest& request) {
  const unsigned type = request.value >> 8U, index = request.value & 0xffU;
  switch (type) {
    case 0x01:
      return copy(kDeviceDescriptor);
    case 0x02:
      return index == 0 ? copy(kConfigurationDescriptor) : Bytes();
    case 0x03: {
      constexpr std::string_view strings[] = {kManufacturer, kProduct, kSerial};
      if (index == 0) return {4, 0x03, 0x09, 0x04};  // American English
      return index <= std::size(strings) ? string_descriptor(strings[index - 1]) : Bytes();
    }
    case 0x21:
      return copy(configuration_descriptor().subspan(18, 9));
    case 0x22:
      return copy(kReportDescriptor);
    default:
      return {};
  }
}

}  // namespace

std::span<const std::uint8_t> device_descriptor() {
  return kDeviceDescriptor;
}

std::span<const std::uint8_t> configuration_descriptor() {
  return kConfigurationDescriptor;
}

std::span<const std::uint8_t> report_descriptor() {
  return kReportDescriptor;
}

ControlRequest::ControlRequest(std::span<const std::uint8_t, 8> setup)
    : request_type(setup[0]),
      request(setup[1]),
      value(static_cast<std::uint16_t>(setup[2] | setup[3] << 8U)),
      index(static_cast<std::uint16_t>(setup[4] | setup[5] << 8U)),
      length(static_cast<std::uint16_t>(setup[6] | setup[7] << 8U)) {}

bool ControlRequest::clears_halt() const {
  constexpr std::uint8_t to_endpoint = 0x02;
  return request_type == to_endpoint && request == kClearFeature && value == kEndpointHalt &&
         index == kEndpoint;
}

ControlAnswer answer_control(const ControlRequest& request) {
  ControlAnswer answer;
  if (!request.is_read()) return answer;
  const bool is_standard = (request.request_type & 0x60U) == 0;
  if (is_standard && request.request == kGetDescriptor) {
    answer.data = descriptor(request);
  } else if (is_standard && request.request == kGetStatus) {
    answer.data = {1, 0};  // self-powered
  } else if (is_standard && request.request == kGetConfiguration) {
    answer.data = {1};
  } else if (is_standard && request.request == kGetInterface) {
    answer.data = {0};
  }
  answer.stalled = answer.data.empty();
  answer.data.resize(std::min<std::size_t>(answer.data.size(), request.length));
  return answer;
}

}  // namespace condyle::host::fake
