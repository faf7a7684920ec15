// SPDX-License-Identifier: Apache-2.0
#include "report/field_check.h"

#include <cmath>
#include <limits>

#include "condyle/hal/report/raw_report.h"
#include "condyle/hal/report/report_field.h"

namespace condyle::hal {
namespace {

bool is_whole_bytes(const ReportField& field) {
  return field.offset_bits % 8 == 0 && field.width_bits % 8 == 0;
}

std::optional<LayoutFault> check_special_values(const ReportField& field) {
  const RawRange possible = possible_values(field);
  const auto is_possible = [&](std::int64_t raw) {
    return raw >= possible.lowest && raw <= possible.highest;
  };
  if (field.missing && !is_possible(*field.missing)) return LayoutFault::missing_value_impossible;
  if (!field.range) return {};
  const bool is_wide_unsigned = field.type == FieldType::unsigned_integer && field.width_bits == 64;
  const bool is_ordered = is_wide_unsigned ? static_cast<std::uint64_t>(field.range->lowest) <=
                                                 static_cast<std::uint64_t>(field.range->highest)
                                           : field.range->lowest <= field.range->highest;
  if (!is_ordered || !is_possible(field.range->lowest) || !is_possible(field.range->highest)) {
    return LayoutFault::range_impossible;
  }
  return {};
}

}  // namespace

RawRange possible_values(const ReportField& field) {
  constexpr RawRange all{std::numeric_limits<std::int64_t>::min(),
                         std::numeric_limits<std::int64_t>::max()};
  if (field.type == FieldType::floating_point || field.width_bits == 64) return all;
  if (field.type == FieldType::unsigned_integer) {
    return {0, static_cast<std::int64_t>((std::uint64_t{1} << field.width_bits) - 1)};
  }
  const std::int64_t half = std::int64_t{1} << (field.width_bits - 1);
  return {-half, half - 1};
}

std::size_t size_to_lie_in(const ReportContent& content, LayoutState state) {
  const bool has_size = content.minimum_size_bytes > 0 || state == LayoutState::complete;
  return has_size ? content.minimum_size_bytes : kMaxReportSize;
}

std::optional<LayoutFault> check_field(const ReportField& field, const ReportLayout& layout,
                                       LayoutState state) {
  if (field.width_bits < 1 || field.width_bits > 64) return LayoutFault::width_not_usable;
  if (field.type == FieldType::floating_point && field.width_bits != 32 && field.width_bits != 64) {
    return LayoutFault::floating_width_not_usable;
  }
  if (field.byte_order == ByteOrder::big && !is_whole_bytes(field)) {
    return LayoutFault::big_endian_of_broken_bytes;
  }
  if (layout.report_id && field.offset_bits < 8) return LayoutFault::on_report_id;
  if (!lies_within(field, size_to_lie_in(layout, state))) return LayoutFault::beyond_report;
  if (!std::isfinite(field.scale) || field.scale == 0) return LayoutFault::scale_not_usable;
  if (!std::isfinite(field.offset)) return LayoutFault::offset_not_finite;
  return check_special_values(field);
}

std::optional<LayoutFault> check_counting(const CountingField& counting, std::uint64_t fewest) {
  if (counting.field.type != FieldType::unsigned_integer) return LayoutFault::count_not_unsigned;
  const std::uint64_t most =
      counting.field.width_bits == 64 ? 0 : std::uint64_t{1} << counting.field.width_bits;
  const std::uint64_t wraps_at = counting.wraps_at == 0 ? most : counting.wraps_at;
  if (most != 0 && wraps_at > most) return LayoutFault::wraps_beyond_width;
  if (wraps_at != 0 && wraps_at < fewest) return LayoutFault::wraps_too_soon;
  return {};
}

std::optional<LayoutFault> check_clock(const CountingField& clock, double rate_Hz) {
  if (!(clock.field.scale >= 1e-9 && clock.field.scale <= 3600)) {
    return LayoutFault::tick_not_usable;
  }
  const double wraps_at =
      clock.wraps_at == 0 ? std::exp2(clock.field.width_bits) : static_cast<double>(clock.wraps_at);
  if (rate_Hz > 0 && wraps_at * clock.field.scale < 2 / rate_Hz) {
    return LayoutFault::clock_wraps_too_soon;
  }
  return {};
}

std::optional<LayoutFault> check_checksum(const Checksum& checksum, std::size_t size_bytes) {
  if (checksum.width_bits != 8 && checksum.width_bits != 16) {
    return LayoutFault::checksum_width_not_usable;
  }
  if (checksum.field.width_bits != checksum.width_bits ||
      checksum.field.type != FieldType::unsigned_integer) {
    return LayoutFault::checksum_field_differs;
  }
  const std::uint32_t most = (std::uint32_t{1} << checksum.width_bits) - 1;
  if (checksum.polynomial == 0 || checksum.polynomial > most || checksum.initial > most ||
      checksum.final_xor > most) {
    return LayoutFault::checksum_parameters_too_wide;
  }
  if (checksum.first_byte >= checksum.end_byte) return LayoutFault::checksum_covers_nothing;
  if (size_bytes > 0 && checksum.end_byte > size_bytes) return LayoutFault::checksum_beyond_report;
  const std::uint64_t first_bit = std::uint64_t{checksum.first_byte} * 8;
  const std::uint64_t end_bit = std::uint64_t{checksum.end_byte} * 8;
  const std::uint64_t field_end =
      std::uint64_t{checksum.field.offset_bits} + checksum.field.width_bits;
  if (checksum.field.offset_bits < end_bit && field_end > first_bit) {
    return LayoutFault::checksum_covers_itself;
  }
  return {};
}

}  // namespace condyle::hal
