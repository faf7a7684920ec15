// SPDX-License-Identifier: Apache-2.0
#include "hosted/config/profile_field_reader.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "condyle/hal/report/raw_report.h"

namespace condyle::host {
namespace {

constexpr std::int64_t kMostBits = std::int64_t{hal::kMaxReportSize} * 8;
constexpr std::int64_t kLowest = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kHighest = std::numeric_limits<std::int64_t>::max();
constexpr Range kScale{-1e15, 1e15};

// "a.b.c": "a.b" and "c".
std::pair<std::string, std::string> split(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos) return {"", path};
  return {path.substr(0, dot), path.substr(dot + 1)};
}

}  // namespace

hal::ReportField FieldText::in_si() const {
  hal::ReportField result = field;
  // Divided, because powers of ten below one are not exact.
  const double per_si = unit != nullptr ? unit->per_si : 1;
  result.scale = scale / per_si;
  result.offset = value_offset / per_si;
  return result;
}

std::uint32_t ProfileFieldReader::read_bits(const std::string& section, const char* key,
                                            std::uint32_t value, std::int64_t lowest,
                                            std::int64_t highest, bool& is_given) {
  std::int64_t bits = value;
  is_given = file_.integer(section, key, bits, lowest, highest) || is_given;
  return static_cast<std::uint32_t>(bits);
}

void ProfileFieldReader::read_place(const std::string& section, FieldText& text) {
  bool in_bytes = false, in_bits = false;
  const std::uint32_t bytes = read_bits(section, "offset_bytes", text.field.offset_bits / 8, 0,
                                        std::int64_t{hal::kMaxReportSize} - 1, in_bytes);
  const std::uint32_t bits =
      read_bits(section, "offset_bits", text.field.offset_bits, 0, kMostBits - 1, in_bits);
  if (in_bytes && in_bits) {
    throw InputError(file_.place(section, "offset_bits"), "the offset is given twice",
                     "give offset_bytes or offset_bits");
  }
  text.field.offset_bits = in_bytes ? bytes * 8 : bits;
  text.has_offset = text.has_offset || in_bytes || in_bits;
  text.field.width_bits =
      read_bits(section, "width_bits", text.field.width_bits, 1, 64, text.has_width);
  std::size_t order = text.field.byte_order == hal::ByteOrder::little ? 0 : 1;
  file_.choice(section, "byte_order", order, {"little", "big"});
  text.field.byte_order = order == 0 ? hal::ByteOrder::little : hal::ByteOrder::big;
}

void ProfileFieldReader::read_stride(const std::string& section, FieldText& text) {
  bool is_given = false;
  text.stride_bits = read_bits(section, "stride_bits", 0, 1, kMostBits, is_given);
}

void ProfileFieldReader::read_value(const std::string& section, FieldText& text) {
  std::size_t type = 0;
  if (file_.choice(section, "type", type, {"unsigned", "signed", "float"})) {
    text.field.type = static_cast<hal::FieldType>(type);
    text.has_type = true;
  }
  file_.number(section, "value_offset", text.value_offset, "units", kScale);
  std::int64_t missing = 0;
  if (file_.integer(section, "missing", missing, kLowest, kHighest)) text.field.missing = missing;
  hal::RawRange range;
  const bool has_lowest = file_.integer(section, "valid_from", range.lowest, kLowest, kHighest);
  const bool has_highest = file_.integer(section, "valid_to", range.highest, kLowest, kHighest);
  if (has_lowest != has_highest) {
    throw InputError(file_.place(section, has_lowest ? "valid_from" : "valid_to"),
                     "one end of the valid range is missing", "give valid_from and valid_to");
  }
  if (has_lowest) text.field.range = range;
}

void ProfileFieldReader::read_scale(const std::string& section, FieldText& text,
                                    const std::vector<ProfileUnit>& units) {
  if (!units.empty()) {
    std::vector<std::string_view> names;
    for (const ProfileUnit& unit : units) names.push_back(unit.name);
    std::size_t unit = 0;
    if (file_.choice(section, "unit", unit, names)) text.unit = &units[unit];
  }
  double counts = 0;
  const bool has_scale = file_.number(section, "scale", text.scale, "units per count", kScale);
  if (file_.number(section, "counts_per_unit", counts, "counts per unit", kScale)) {
    if (has_scale) {
      throw InputError(file_.place(section, "counts_per_unit"), "the scale is given twice",
                       "give scale or counts_per_unit");
    }
    if (counts == 0) {
      throw InputError(file_.place(section, "counts_per_unit"), "counts_per_unit is zero",
                       "give the counts that make one unit");
    }
    text.scale = 1 / counts;
  } else if (has_scale && text.scale == 0) {
    throw InputError(file_.place(section, "scale"), "scale is zero",
                     "give the units that one count stands for");
  }
}

void ProfileFieldReader::require_field(const std::string& section, const FieldText& text,
                                       bool needs_unit) {
  require(text.has_offset, section, "offset_bytes",
          "give the byte at which the field starts (or offset_bits)");
  require(text.has_width, section, "width_bits", "give the width of the field, 1 to 64 bits");
  require(text.has_type, section, "type", "give \"unsigned\", \"signed\" or \"float\"");
  require(!needs_unit || text.unit != nullptr, section, "unit", "give the unit of the values");
}

void ProfileFieldReader::require(bool is_given, const std::string& section, const std::string& key,
                                 const std::string& mend) {
  if (is_given || missing_) return;
  const std::string where = section.empty() ? "" : fmt::format(" in [{}]", section);
  missing_.emplace(place_of(section), fmt::format("{} is missing{}", key, where), mend);
}

void ProfileFieldReader::finish() const {
  if (missing_) throw *missing_;
}

bool ProfileFieldReader::is_there(const std::string& path) const {
  const auto [section, key] = split(path);
  return file_.has(section, key);
}

std::string ProfileFieldReader::place_of(const std::string& path) const {
  const auto [section, key] = split(path);
  if (!section.empty() && !file_.has(section, key)) return place_of(section);
  return file_.place(section, key);
}

}  // namespace condyle::host
