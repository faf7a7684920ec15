// SPDX-License-Identifier: Apache-2.0
// Extracts numbers from the bits of a report.
#pragma once

#include <cstdint>
#include <span>

#include "condyle/hal/report/report_layout.h"

namespace condyle::hal {

/// A measured value; NaN if it is not valid.
struct MeasuredValue {
  double value = 0;
  bool valid = false;
};

/// True if all bits of `field` lie inside a report of `size_bytes`.
constexpr bool lies_within(const ReportField& field, std::size_t size_bytes) {
  return field.width_bits >= 1 &&
         std::uint64_t{field.offset_bits} + field.width_bits <= std::uint64_t{size_bytes} * 8;
}

/// The field's bits as an unsigned number. The field must be valid and inside `bytes`.
std::uint64_t read_raw(const ReportField& field, std::span<const std::uint8_t> bytes);

/// The field's value in SI, under the same condition. Not valid if the raw value is `missing` or
/// outside `range`, or if the value is not finite.
MeasuredValue read_value(const ReportField& field, std::span<const std::uint8_t> bytes);

}  // namespace condyle::hal
