// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/estimator/parameter_range.h"

namespace condyle::host {

/// Reads a TOML file field by field into variables that keep their value where the file is silent.
/// Every problem is an InputError that names line, column and mend; so is, at the end, a key that
/// nobody asked for. `section` is "" at the top level, "outer.inner" for a section in a section.
class TomlReader {
 public:
  explicit TomlReader(const std::string& path);
  /// Reads `text` itself; messages call it `name`.
  TomlReader(const std::string& name, std::string_view text);
  ~TomlReader();
  TomlReader(const TomlReader&) = delete;
  TomlReader& operator=(const TomlReader&) = delete;

  /// One number in `range`. True where the file has it (here and below).
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
  /// A text that is one of `choices`; its index is given.
  bool choice(std::string_view section, std::string_view key, std::size_t& index,
              const std::vector<std::string_view>& choices);
  /// An array of `count` texts out of `choices`; their indices are given.
  bool choices(std::string_view section, std::string_view key, std::vector<std::size_t>& indices,
               std::size_t count, const std::vector<std::string_view>& choices);
  /// Any text.
  bool text(std::string_view section, std::string_view key, std::string& value);
  /// True where the file has this key, or with section "" this section. Does not make it known.
  bool has(std::string_view section, std::string_view key) const;
  /// Names of the sections in `section`, sorted.
  std::vector<std::string> sections_in(std::string_view section) const;
  /// Refuses whatever was not asked for.
  void finish() const;
  /// "FILE:LINE:COLUMN" of a key, or the file where it has none.
  std::string place(std::string_view section, std::string_view key) const;

 private:
  struct Document;
  std::unique_ptr<Document> document_;
};

}  // namespace condyle::host
