// SPDX-License-Identifier: Apache-2.0
// Captures of USB traffic as usbmon and Wireshark's tools write them, in every form there is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace condyle::testing_support {

/// A packet of usbmon (Documentation/usb/usbmon.rst, binary API).
struct CapturedPacket {
  char event = 'C';
  int transfer_type = 1;  // interrupt
  int endpoint = 0x81, device = 5, bus = 2;
  std::int32_t status = 0;
  std::uint64_t id = 1;
  std::int64_t time_us = 0;
  std::string setup;  // 8 bytes, or none
  std::string data;
  std::size_t cut_to = ~std::size_t{0};  // bytes of data that were captured
};

/// Writes a capture.
class CaptureFile {
 public:
  struct Form {
    bool is_pcapng = false, is_big_endian = false, is_mmapped = false;
  };

  explicit CaptureFile(const Form& form, std::uint32_t link_type = 0) : form_(form) {
    if (link_type == 0) link_type = form.is_mmapped ? 220 : 189;
    if (form.is_pcapng) {
      content_ = number(0x0a0d0d0a, 4) + number(28, 4) + number(0x1a2b3c4d, 4) + number(1, 2) +
                 number(0, 2) + number(~std::uint64_t{0}, 8) + number(28, 4);
      content_ += number(1, 4) + number(20, 4) + number(link_type, 2) + number(0, 2) +
                  number(262'144, 4) + number(20, 4);
    } else {
      content_ = number(0xa1b2c3d4, 4) + number(2, 2) + number(4, 2) + number(0, 4) + number(0, 4) +
                 number(262'144, 4) + number(link_type, 4);
    }
  }

  void add(const CapturedPacket& packet) {
    const std::string captured = packet.data.substr(0, packet.cut_to);
    const bool has_data = !captured.empty();
    std::string bytes =
        number(packet.id, 8) + packet.event + static_cast<char>(packet.transfer_type) +
        static_cast<char>(packet.endpoint) + static_cast<char>(packet.device) +
        number(static_cast<std::uint64_t>(packet.bus), 2) + (packet.setup.empty() ? '-' : '\0') +
        (has_data ? '\0' : '<') +
        number(static_cast<std::uint64_t>(packet.time_us / 1'000'000), 8) +
        number(static_cast<std::uint64_t>(packet.time_us % 1'000'000), 4) +
        number(static_cast<std::uint32_t>(packet.status), 4) + number(packet.data.size(), 4) +
        number(captured.size(), 4) + (packet.setup.empty() ? std::string(8, '\0') : packet.setup);
    if (form_.is_mmapped) bytes += std::string(16, '\0');
    const std::size_t full = bytes.size() + packet.data.size();
    bytes += captured;
    const auto time_us = static_cast<std::uint64_t>(packet.time_us);
    if (form_.is_pcapng) {
      const std::string padding((4 - bytes.size() % 4) % 4, '\0');
      const std::string length = number(32 + bytes.size() + padding.size(), 4);
      content_ += number(6, 4) + length + number(0, 4) + number(time_us >> 32U, 4) +
                  number(time_us & 0xffffffffU, 4) + number(bytes.size(), 4) + number(full, 4) +
                  bytes + padding + length;
    } else {
      content_ += number(time_us / 1'000'000, 4) + number(time_us % 1'000'000, 4) +
                  number(bytes.size(), 4) + number(full, 4) + bytes;
    }
  }

  /// The host asks device `device` of bus 2 for its descriptor, and gets it.
  void add_descriptor(int device, std::uint16_t vendor_id, std::uint16_t product_id) {
    CapturedPacket packet;
    packet.event = 'S';
    packet.transfer_type = 2;
    packet.endpoint = 0x80;
    packet.device = device;
    packet.id = 900;
    packet.setup = std::string("\x80\x06\x00\x01\x00\x00\x12\x00", 8);
    add(packet);
    packet.event = 'C';
    packet.setup.clear();
    packet.data = std::string("\x12\x01\x00\x02\x00\x00\x00\x40", 8);
    for (const std::uint16_t id : {vendor_id, product_id}) {
      packet.data += static_cast<char>(id);
      packet.data += static_cast<char>(id >> 8U);
    }
    packet.data += std::string("\x00\x01\x01\x02\x03\x01", 6);
    add(packet);
  }

  const std::string& content() const { return content_; }

 private:
  std::string number(std::uint64_t value, int size) const {
    std::string bytes;
    for (int i = 0; i < size; ++i) {
      bytes += static_cast<char>(value >> (8 * (form_.is_big_endian ? size - 1 - i : i)));
    }
    return bytes;
  }

  Form form_;
  std::string content_;
};

}  // namespace condyle::testing_support
