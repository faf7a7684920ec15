// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/report_field.h"

#include <bit>
#include <cmath>
#include <limits>

namespace condyle::hal {
namespace {

double floating_point(std::uint64_t raw, std::uint32_t width_bits) {
  if (width_bits == 64) return std::bit_cast<double>(raw);
  return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
}

std::int64_t sign_extended(std::uint64_t raw, std::uint32_t width_bits) {
  const unsigned unused = 64 - width_bits;
  return static_cast<std::int64_t>(raw << unused) >> unused;
}

}  // namespace

std::uint64_t read_raw(const ReportField& field, std::span<const std::uint8_t> bytes) {
  const std::size_t first = field.offset_bits / 8;
  const std::size_t last = (field.offset_bits + field.width_bits - 1) / 8;
  std::uint64_t raw = 0;
  if (field.byte_order == ByteOrder::big) {
    for (std::size_t i = first; i <= last; ++i) raw = raw << 8U | bytes[i];
    return raw;
  }
  const unsigned shift = field.offset_bits % 8;
  for (std::size_t i = first; i <= last && i < first + 8; ++i) {
    raw |= std::uint64_t{bytes[i]} << 8 * (i - first);
  }
  raw >>= shift;
  // 64 bits that start inside a byte extend into a ninth.
  if (last - first == 8) raw |= std::uint64_t{bytes[last]} << (64 - shift);
  return field.width_bits == 64 ? raw : raw & ((std::uint64_t{1} << field.width_bits) - 1);
}

MeasuredValue read_value(const ReportField& field, std::span<const std::uint8_t> bytes) {
  const std::uint64_t raw = read_raw(field, bytes);
  double number = 0;
  bool is_measured = true;
  const auto judge = [&](auto comparable) {
    using Comparable = decltype(comparable);
    if (field.missing) is_measured = comparable != static_cast<Comparable>(*field.missing);
    if (field.range) {
      is_measured = is_measured && comparable >= static_cast<Comparable>(field.range->lowest) &&
                    comparable <= static_cast<Comparable>(field.range->highest);
    }
  };
  switch (field.type) {
    case FieldType::floating_point:
      number = floating_point(raw, field.width_bits);
      judge(number);
      break;
    case FieldType::signed_integer:
      number = static_cast<double>(sign_extended(raw, field.width_bits));
      judge(sign_extended(raw, field.width_bits));
      break;
    case FieldType::unsigned_integer:
      number = static_cast<double>(raw);
      judge(raw);
      break;
  }
  const double value = number * field.scale + field.offset;
  if (is_measured && std::isfinite(value)) return {value, true};
  return {std::numeric_limits<double>::quiet_NaN(), false};
}

}  // namespace condyle::hal
