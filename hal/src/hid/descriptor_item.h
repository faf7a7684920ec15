// SPDX-License-Identifier: Apache-2.0
// The items of which a report descriptor consists.
#pragma once

#include <cstddef>
#include <cstdint>

namespace condyle::hal::descriptor_items {

// HID 1.11, section 6.2.2.2 to 6.2.2.8.
enum ItemType : std::uint8_t { main_item, global_item, local_item, reserved_item };
enum MainTag : std::uint8_t {
  input_tag = 8,
  output_tag,
  collection_tag,
  feature_tag,
  end_collection_tag
};
enum GlobalTag : std::uint8_t {
  usage_page_tag,
  logical_minimum_tag,
  logical_maximum_tag,
  physical_minimum_tag,
  physical_maximum_tag,
  unit_exponent_tag,
  unit_tag,
  report_size_tag,
  report_id_tag,
  report_count_tag,
  push_tag,
  pop_tag
};
enum LocalTag : std::uint8_t {
  usage_tag,
  usage_minimum_tag,
  usage_maximum_tag,
  designator_index_tag,
  designator_minimum_tag,
  designator_maximum_tag,
  string_index_tag = 7,
  string_minimum_tag,
  string_maximum_tag,
  delimiter_tag
};
constexpr std::uint8_t kLongItem = 0xFE;

// Data of a short item, read as unsigned and as signed.
struct Item {
  std::uint8_t type = 0, tag = 0;
  std::size_t size = 0;
  std::uint32_t value = 0;

  std::int64_t signed_value() const {
    if (size == 0) return 0;
    const auto sign = std::uint64_t{1} << (8 * size - 1);
    return static_cast<std::int64_t>(value ^ sign) - static_cast<std::int64_t>(sign);
  }
};

// A range whose maximum is unsigned if its minimum is not negative, as devices use it.
struct ItemRange {
  std::int64_t minimum = 0;
  Item maximum_item;

  std::int64_t maximum() const {
    return minimum < 0 ? maximum_item.signed_value() : std::int64_t{maximum_item.value};
  }
};

}  // namespace condyle::hal::descriptor_items
