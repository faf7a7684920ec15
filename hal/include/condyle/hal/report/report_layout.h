// SPDX-License-Identifier: Apache-2.0
// What the bits of a device's reports mean: everything that a decoder needs. Plain values without
// heap, so that they can be sent to a target without an operating system.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "condyle/estimator/sample.h"
#include "condyle/hal/fixed_list.h"

namespace condyle::hal {

/// Order of the bytes of a field.
enum class ByteOrder : std::uint8_t { little, big };

/// How to interpret the bits of a field.
enum class FieldType : std::uint8_t { unsigned_integer, signed_integer, floating_point };

/// Raw values `lowest` to `highest`, both included.
struct RawRange {
  std::int64_t lowest = 0;
  std::int64_t highest = 0;
};

/// A number inside a report. Bits are counted from the report's first byte (the report id, if
/// reports are numbered), and within a byte from its least significant bit, as in HID 1.11.
struct ReportField {
  std::uint32_t offset_bits = 0;
  std::uint32_t width_bits = 0;  ///< 1 to 64; 32 or 64 for floating_point
  FieldType type = FieldType::signed_integer;
  ByteOrder byte_order = ByteOrder::little;  ///< big: whole bytes only
  double scale = 1;                          ///< value in SI = raw * scale + offset
  double offset = 0;
  /// Raw value that means "not measured"; for a floating_point field, the number itself. Raw values
  /// of 64 unsigned bits count as two's complement, here and in `range`.
  std::optional<std::int64_t> missing;
  std::optional<RawRange> range;  ///< raw values outside it mean "not measured"
};

/// A coordinate: a field and its place in the sample.
struct CoordinateField {
  ReportField field;      ///< scaled to metres, or for a quaternion to 1
  std::size_t index = 0;  ///< in Sample::coordinates
};

/// A count or clock that wraps at 2^width_bits, or at `wraps_at` raw units.
struct CountingField {
  ReportField field;
  std::uint64_t wraps_at = 0;  ///< 0: 2^width_bits
};

/// A cyclic redundancy check in the Rocksoft model (R. Williams, "A painless guide to CRC error
/// detection algorithms", 1993), over bytes [first_byte, end_byte) of the report.
struct Checksum {
  ReportField field;
  unsigned width_bits = 16;  ///< 8 or 16
  std::uint32_t polynomial = 0;
  std::uint32_t initial = 0;
  bool reflects_input = false;
  bool reflects_output = false;
  std::uint32_t final_xor = 0;
  std::size_t first_byte = 0;
  std::size_t end_byte = 0;
};

/// Most coordinates of a report.
inline constexpr std::size_t kMaxCoordinates = 9;

/// Most auxiliary fields of a report.
inline constexpr std::size_t kMaxAuxiliary = 32;

/// The content of a report without its auxiliary fields, which also have names in a profile.
struct ReportContent {
  double rate_Hz = 0;                     ///< nominal; 0: not known
  std::optional<std::uint8_t> report_id;  ///< absent: reports are not numbered
  std::size_t minimum_size_bytes = 0;     ///< of a report, report id included
  SampleKind kind = SampleKind::one_point;
  FixedList<CoordinateField, kMaxCoordinates> coordinates;
  std::optional<CountingField> device_time;  ///< field.scale: seconds per unit
  std::optional<CountingField> sequence;     ///< increases by one with each report
  std::optional<Checksum> checksum;
  std::optional<ReportField> drive_N;
  bool restarts_on_reconnect = false;  ///< its counter and clock restart when plugged in
};

/// Everything that a decoder needs. find_layout_problem (layout_check.h) checks that it is usable.
struct ReportLayout : ReportContent {
  FixedList<ReportField, kMaxAuxiliary> auxiliary;  ///< further measured values, to SI
};
static_assert(std::is_trivially_copyable_v<ReportLayout>);

}  // namespace condyle::hal
