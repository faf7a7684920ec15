// SPDX-License-Identifier: Apache-2.0
// The fields of a device profile as written in the TOML file. Private to device_profile_file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "condyle/hal/hid/device_profile.h"
#include "hosted/files/input_error.h"
#include "hosted/files/toml_reader.h"

namespace condyle::host {

/// A unit of a profile, and how many of it make one SI unit.
struct ProfileUnit {
  std::string_view name;
  std::string_view si;
  double per_si;
};

/// A field as its section describes it, values still in the section's unit.
struct FieldText {
  hal::ReportField field;
  bool has_offset = false, has_width = false, has_type = false;
  const ProfileUnit* unit = nullptr;  ///< null: none is given
  double scale = 1;                   ///< units a count
  double value_offset = 0;            ///< units
  std::uint32_t stride_bits = 0;      ///< 0: the width

  /// The field in SI.
  hal::ReportField in_si() const;
};

/// Reads fields. Missing keys are remembered until all unknown keys have been reported, because a
/// misspelt key explains a missing one.
class ProfileFieldReader {
 public:
  explicit ProfileFieldReader(TomlReader& file) : file_(file) {}

  /// Place, width and byte order.
  void read_place(const std::string& section, FieldText& text);
  /// Type, offset and the values that mean "not measured".
  void read_value(const std::string& section, FieldText& text);
  /// Scale; unit if there are `units`, which must outlive `text`.
  void read_scale(const std::string& section, FieldText& text,
                  const std::vector<ProfileUnit>& units);
  /// Distance from one field to the next.
  void read_stride(const std::string& section, FieldText& text);
  /// Remembers an InputError if place, width, type or unit is missing.
  void require_field(const std::string& section, const FieldText& text, bool needs_unit);
  /// Remembers an InputError unless `is_given`.
  void require(bool is_given, const std::string& section, const std::string& key,
               const std::string& mend);
  /// Throws the first remembered InputError.
  void finish() const;

  /// True if the file has a section (or key) of this path.
  bool is_there(const std::string& path) const;
  /// "FILE:LINE:COLUMN" of a section (or key), or of the nearest enclosing one that exists.
  std::string place_of(const std::string& path) const;

 private:
  std::uint32_t read_bits(const std::string& section, const char* key, std::uint32_t value,
                          std::int64_t lowest, std::int64_t highest, bool& is_given);

  TomlReader& file_;
  std::optional<InputError> missing_;
};

}  // namespace condyle::host
