// SPDX-License-Identifier: Apache-2.0
#include "field_check.h"

#include <cmath>
#include <limits>

#include "condyle/hal/raw_report.h"
#include "condyle/hal/report_field.h"

namespace condyle::hal {
namespace {

using MaybeProblem = std::optional<FieldProblem>;

bool is_whole_bytes(const ReportField& field) {
  return field.offset_bits % 8 == 0 && field.width_bits % 8 == 0;
}

// Raw values that `field` can hold; all of int64 where it is as wide.
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

MaybeProblem check_special_values(const ReportField& field) {
  const RawRange possible = possible_values(field);
  const auto is_possible = [&](std::int64_t raw) {
    return raw >= possible.lowest && raw <= possible.highest;
  };
  if (field.missing && !is_possible(*field.missing)) {
    return FieldProblem{"never holds the value " + std::to_string(*field.missing) + " (missing)",
                        "its bits hold " + std::to_string(possible.lowest) + " to " +
                            std::to_string(possible.highest)};
  }
  if (!field.range) return {};
  const bool is_wide_unsigned = field.type == FieldType::unsigned_integer && field.width_bits == 64;
  const bool is_ordered = is_wide_unsigned ? static_cast<std::uint64_t>(field.range->lowest) <=
                                                 static_cast<std::uint64_t>(field.range->highest)
                                           : field.range->lowest <= field.range->highest;
  if (!is_ordered || !is_possible(field.range->lowest) || !is_possible(field.range->highest)) {
    return FieldProblem{"has a valid range that its bits never hold",
                        "give the lowest and the highest of " + std::to_string(possible.lowest) +
                            " to " + std::to_string(possible.highest)};
  }
  return {};
}

}  // namespace

std::optional<FieldProblem> check_field(const ReportField& field, const DeviceProfile& profile) {
  if (field.width_bits < 1 || field.width_bits > 64) {
    return FieldProblem{"is " + std::to_string(field.width_bits) + " bits wide", "give 1 to 64"};
  }
  if (field.type == FieldType::floating_point && field.width_bits != 32 && field.width_bits != 64) {
    return FieldProblem{
        "is a floating-point number of " + std::to_string(field.width_bits) + " bits",
        "they have 32 or 64"};
  }
  if (field.byte_order == ByteOrder::big && !is_whole_bytes(field)) {
    return FieldProblem{"is big-endian, but not of whole bytes",
                        "make offset and width multiples of 8, or the byte order little"};
  }
  if (profile.report_id && field.offset_bits < 8) {
    return FieldProblem{"lies on the report id, which is byte 0", "start at byte 1 or later"};
  }
  // Where the descriptor is to tell the size, any report's size will do until then.
  const bool has_size = profile.minimum_size_bytes > 0 || !profile.descriptor_axes;
  const std::size_t size_bytes = has_size ? profile.minimum_size_bytes : kMaxReportSize;
  if (!lies_within(field, size_bytes)) {
    return FieldProblem{"reaches beyond the report's " + std::to_string(size_bytes) + " bytes",
                        "raise the minimum size, or move the field"};
  }
  if (!std::isfinite(field.scale) || field.scale == 0) {
    return FieldProblem{"has a scale that is zero or not finite", "give the value of one raw unit"};
  }
  if (!std::isfinite(field.offset)) return FieldProblem{"has an offset that is not finite", ""};
  return check_special_values(field);
}

std::optional<FieldProblem> check_counting(const CountingField& counting, std::uint64_t fewest) {
  if (counting.field.type != FieldType::unsigned_integer) {
    return FieldProblem{"is not an unsigned integer", "counts are"};
  }
  const std::uint64_t most =
      counting.field.width_bits == 64 ? 0 : std::uint64_t{1} << counting.field.width_bits;
  const std::uint64_t wraps_at = counting.wraps_at == 0 ? most : counting.wraps_at;
  if (most != 0 && wraps_at > most) {
    return FieldProblem{"wraps at more than its bits hold",
                        "leave wraps_at out, or widen the field"};
  }
  if (wraps_at != 0 && wraps_at < fewest) {
    return FieldProblem{
        "starts again after " + std::to_string(wraps_at) + " values: nothing can be told",
        "leave it out"};
  }
  return {};
}

std::optional<FieldProblem> check_clock(const CountingField& clock, double rate_Hz) {
  if (!(clock.field.scale >= 1e-9 && clock.field.scale <= 3600)) {
    return FieldProblem{"has ticks shorter than a nanosecond or longer than an hour",
                        "correct scale and unit"};
  }
  const double wraps_at =
      clock.wraps_at == 0 ? std::exp2(clock.field.width_bits) : static_cast<double>(clock.wraps_at);
  if (rate_Hz > 0 && wraps_at * clock.field.scale < 2 / rate_Hz) {
    return FieldProblem{"starts again before two reports have come: time cannot be told from it",
                        "leave it out, or correct unit, width or rate"};
  }
  return {};
}

std::optional<FieldProblem> check_checksum(const Checksum& checksum, std::size_t size_bytes) {
  if (checksum.width_bits != 8 && checksum.width_bits != 16) {
    return FieldProblem{"is " + std::to_string(checksum.width_bits) + " bits wide", "give 8 or 16"};
  }
  if (checksum.field.width_bits != checksum.width_bits ||
      checksum.field.type != FieldType::unsigned_integer) {
    return FieldProblem{"has a field of another width or type",
                        "make it unsigned, as wide as the sum"};
  }
  const std::uint32_t most = (std::uint32_t{1} << checksum.width_bits) - 1;
  if (checksum.polynomial == 0 || checksum.polynomial > most || checksum.initial > most ||
      checksum.final_xor > most) {
    return FieldProblem{
        "has a polynomial of zero, or a parameter wider than the sum",
        "give them without the polynomial's top bit, at most " + std::to_string(most)};
  }
  if (checksum.first_byte >= checksum.end_byte) {
    return FieldProblem{"covers no bytes", "give the first and the last byte it is taken over"};
  }
  if (size_bytes > 0 && checksum.end_byte > size_bytes) {
    return FieldProblem{"covers bytes beyond the report's " + std::to_string(size_bytes),
                        "raise the minimum size, or end earlier"};
  }
  const std::uint64_t first_bit = std::uint64_t{checksum.first_byte} * 8;
  const std::uint64_t end_bit = std::uint64_t{checksum.end_byte} * 8;
  const std::uint64_t field_end =
      std::uint64_t{checksum.field.offset_bits} + checksum.field.width_bits;
  if (checksum.field.offset_bits < end_bit && field_end > first_bit) {
    return FieldProblem{"covers its own bytes", "end before them, or start after"};
  }
  return {};
}

}  // namespace condyle::hal
