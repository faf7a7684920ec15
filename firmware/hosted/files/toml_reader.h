// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/estimator/parameter_range.h"

namespace condyle::host {

/// Reads a TOML file field by field into variables, which keep their value if the file does not
/// have the key. Every problem is an InputError that names line, column and remedy; unknown keys
/// are reported at the end. `section` is "" at the top level, "outer.inner" for a nested section.
class TomlReader {
 public:
  explicit TomlReader(const std::string& path);
  /// Reads `text` itself; messages call it `name`.
  TomlReader(const std::string& name, std::string_view text);
  ~TomlReader();
  TomlReader(const TomlReader&) = delete;
  TomlReader& operator=(const TomlReader&) = delete;

  /// One number in `range`. True if the file has it (here and below).
  bool number(std::string_view section, std::string_view key, double& value, std::string_view unit,
              Range range);
  /// An array of exactly `count` numbers, each in `range`.
  bool numbers(std::string_view section, std::string_view key, double* values, std::size_t count,
               std::string_view unit, Range range);
  /// An array of any number of numbers, each in `range`.
  bool list(std::string_view section, std::string_view key, std::vector<double>& values,
            std::string_view unit, Range range);
  /// A whole number from `lowest` to `highest`.
  bool integer(std::string_view section, std::string_view key, std::int64_t& value,
               std::int64_t lowest, std::int64_t highest);
  /// true or false.
  bool boolean(std::string_view section, std::string_view key, bool& value);
  /// A text that is one of `choices`; returns its index.
  bool choice(std::string_view section, std::string_view key, std::size_t& index,
              const std::vector<std::string_view>& choices);
  /// An array of `count` texts out of `choices`; returns their indices.
  bool choices(std::string_view section, std::string_view key, std::vector<std::size_t>& indices,
               std::size_t count, const std::vector<std::string_view>& choices);
  /// Any text.
  bool text(std::string_view section, std::string_view key, std::string& value);
  /// True if the file has this key; with section "", also a section of this name. Does not mark it
  /// as known.
  bool has(std::string_view section, std::string_view key) const;
  /// Names of the sections in `section`, sorted.
  std::vector<std::string> sections_in(std::string_view section) const;
  /// Throws an InputError for any key that was not read.
  void finish() const;
  /// "FILE:LINE:COLUMN" of a key, or the file if it lacks the key.
  std::string place(std::string_view section, std::string_view key) const;

 private:
  struct Document;
  std::unique_ptr<Document> document_;
};

}  // namespace condyle::host
