// SPDX-License-Identifier: Apache-2.0
// Report descriptors written item by item.
#pragma once

#include <cstdint>
#include <vector>

namespace condyle::testing_support {

/// Appends items to a descriptor. Tags with their type are HID 1.11's prefix bytes without size.
class DescriptorBytes {
 public:
  /// An item in the fewest bytes that hold `value`, read as signed; `size`: exactly so many.
  DescriptorBytes& item(std::uint8_t tag, std::int64_t value, int size = -1) {
    if (size < 0)
      size = value >= -128 && value < 128 ? 1 : value >= -32768 && value < 32768 ? 2 : 4;
    bytes.push_back(static_cast<std::uint8_t>(tag | (size == 4 ? 3 : size)));
    for (int i = 0; i < size; ++i) {
      bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    }
    return *this;
  }
  DescriptorBytes& usage_page(std::int64_t page) { return item(0x04, page, 2); }
  DescriptorBytes& usage(std::int64_t usage) { return item(0x08, usage, usage > 0xFFFF ? 4 : 2); }
  DescriptorBytes& logical(std::int64_t minimum, std::int64_t maximum) {
    return item(0x14, minimum, 4).item(0x24, maximum, 4);
  }
  DescriptorBytes& physical(std::int64_t minimum, std::int64_t maximum) {
    return item(0x34, minimum, 4).item(0x44, maximum, 4);
  }
  DescriptorBytes& unit(std::int64_t code, std::int64_t exponent) {
    return item(0x64, code, 4).item(0x54, exponent & 0xF, 1);
  }
  DescriptorBytes& values(std::int64_t width_bits, std::int64_t count) {
    return item(0x74, width_bits, 2).item(0x94, count, 2);
  }
  DescriptorBytes& report_id(std::int64_t id) { return item(0x84, id, 1); }
  DescriptorBytes& input(std::int64_t flags = 2) { return item(0x80, flags, 1); }
  DescriptorBytes& output(std::int64_t flags = 2) { return item(0x90, flags, 1); }
  DescriptorBytes& feature(std::int64_t flags = 2) { return item(0xB0, flags, 1); }
  DescriptorBytes& begin(std::int64_t type = 1) { return item(0xA0, type, 1); }
  DescriptorBytes& end() { return item(0xC0, 0, 0); }
  DescriptorBytes& push() { return item(0xA4, 0, 0); }
  DescriptorBytes& pop() { return item(0xB4, 0, 0); }

  std::vector<std::uint8_t> bytes;
};

}  // namespace condyle::testing_support
