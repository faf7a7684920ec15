// SPDX-License-Identifier: Apache-2.0
// The USB side of the fake facebow: descriptors, strings, answers on endpoint 0.
//
// Sources: USB 2.0, chapter 9 (requests, standard descriptors); HID 1.11, sections 6.2 and 7
// (HID and report descriptor, class requests). The ids are reserved by pid.codes for tests.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace condyle::host::fake {

inline constexpr std::uint16_t kVendorId = 0x1209;
inline constexpr std::uint16_t kProductId = 0x0001;
inline constexpr std::uint16_t kDeviceVersion = 0x0100;  ///< binary-coded decimal: 1.00
inline constexpr std::string_view kManufacturer = "condyle";
inline constexpr std::string_view kProduct = "fake facebow";
inline constexpr std::string_view kSerial = "FAKE0001";
/// The endpoint of the reports: interrupt IN.
inline constexpr std::uint8_t kEndpoint = 0x81;
inline constexpr std::size_t kLargestPacket = 64;

/// The descriptors, as sent over the bus.
std::span<const std::uint8_t> device_descriptor();
/// Configuration with interface, HID and endpoint descriptor.
std::span<const std::uint8_t> configuration_descriptor();
/// Vendor-defined: report 1, 28 bytes of input.
std::span<const std::uint8_t> report_descriptor();

/// A request on endpoint 0.
struct ControlRequest {
  std::uint8_t request_type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0, index = 0, length = 0;

  /// From the 8 bytes of a setup packet.
  explicit ControlRequest(std::span<const std::uint8_t, 8> setup);
  /// True if data goes from the device to the host.
  bool is_read() const { return (request_type & 0x80U) != 0; }
  /// True for CLEAR_FEATURE(ENDPOINT_HALT) of the endpoint of the reports.
  bool clears_halt() const;
};

/// The device's answer; `data` has at most the requested length.
struct ControlAnswer {
  bool stalled = false;  ///< the device does not know the request
  std::vector<std::uint8_t> data;
};

/// Answers a request. The device has no settings: it accepts every valid one.
ControlAnswer answer_control(const ControlRequest& request);

}  // namespace condyle::host::fake
