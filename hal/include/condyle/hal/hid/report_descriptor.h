// SPDX-License-Identifier: Apache-2.0
// HID report descriptors, decoded into the fields of their reports.
//
// Source: USB Device Class Definition for Human Interface Devices (HID) 1.11, sections 5.2 to 5.9
// and 6.2.2. A descriptor is a list of items. Global items set a state that stays (usage page,
// logical and physical range, unit, exponent, report size, count and id), local items one that the
// next main item uses up (usages), main items make collections and fields.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace condyle::hal {

/// Which way a report goes.
enum class ReportDirection : std::uint8_t { input, output, feature };

/// "input", "output" or "feature".
constexpr const char* direction_name(ReportDirection direction) {
  constexpr const char* names[] = {"input", "output", "feature"};
  return names[static_cast<int>(direction)];
}

/// Usages `first` to `last`, both included; page << 16 | id.
struct UsageRange {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

/// How a field's physical values convert to SI.
struct FieldUnit {
  std::uint32_t code = 0;     ///< HID unit item; 0: none
  std::int32_t exponent = 0;  ///< powers of ten
  std::string text;           ///< in SI: "m", "m/s^2", "rad"; "" if it has none
  /// SI = logical * scale + offset; absent if no conversion is defined (no unit or, for
  /// temperatures and reserved systems, an affine or unknown one).
  std::optional<double> scale;
  std::optional<double> offset;
};

/// The fields one Input, Output or Feature item makes: `count` values of `width_bits` each.
struct DescriptorField {
  std::uint32_t offset_bits = 0;  ///< of the first value, from the report's first byte, id included
  std::uint32_t width_bits = 0;
  std::uint32_t count = 0;
  std::uint32_t flags = 0;         ///< the main item's data
  std::vector<UsageRange> usages;  ///< in order; the last one applies to all values after it
  std::int64_t logical_minimum = 0, logical_maximum = 0;
  std::int64_t physical_minimum = 0, physical_maximum = 0;  ///< as used: logical if both are 0
  FieldUnit unit;

  /// Padding: its values have no meaning.
  bool is_constant() const { return (flags & 1U) != 0; }
  /// One value for each usage; if false, values are indices into the usages.
  bool is_variable() const { return (flags & 2U) != 0; }
  /// Relative to the previous report.
  bool is_relative() const { return (flags & 4U) != 0; }
  /// A raw value is signed if the logical range extends below zero.
  bool is_signed() const { return logical_minimum < 0; }
  /// Usage of value `index` of a variable field; 0 if it has none.
  std::uint32_t usage_of(std::uint32_t index) const;
};

/// One report, as sent or received in one piece.
struct DescribedReport {
  std::optional<std::uint8_t> id;  ///< absent if reports are not numbered
  ReportDirection direction = ReportDirection::input;
  std::uint32_t size_bits = 0;  ///< report id included
  std::vector<DescriptorField> fields;
};

/// A decoded descriptor.
struct ReportDescriptor {
  std::vector<DescribedReport> reports;  ///< in the order in which they first appear
  std::vector<UsageRange> applications;  ///< usages of the application collections
  std::vector<std::string> notes;        ///< oddities without effect on the fields
};

/// Why a descriptor was refused.
struct DescriptorError {
  std::size_t byte_offset = 0;  ///< of the item
  std::string reason;
};

/// A descriptor, or the reason why it was refused.
struct DescriptorResult {
  std::optional<ReportDescriptor> descriptor;
  DescriptorError error;  ///< set only if there is no descriptor
};

/// Longest descriptor accepted (bytes), as in Linux (HID_MAX_DESCRIPTOR_SIZE).
inline constexpr std::size_t kMaxDescriptorSize = 4096;

/// Decodes `bytes`; never throws because of their values (memory apart).
DescriptorResult parse_report_descriptor(std::span<const std::uint8_t> bytes);

}  // namespace condyle::hal
