// SPDX-License-Identifier: Apache-2.0
// MAT files of MATLAB, version 5, read by libmatio.
#pragma once

#include <memory>
#include <string>
#include <vector>

struct _mat_t;
struct matvar_t;

namespace condyle::host {

/// An array of a MAT file; valid as long as its MatFile. It may be none: then it has no elements.
class MatArray {
 public:
  MatArray() = default;
  explicit MatArray(const matvar_t* array) : array_(array) {}

  bool is_there() const { return array_ != nullptr; }
  bool is_struct() const;
  bool is_cell() const;
  bool is_text() const;
  /// Real numbers, also logical ones.
  bool is_numeric() const;
  /// Sizes, the index that changes fastest first; at least two.
  std::vector<std::size_t> sizes() const;
  std::size_t count() const;
  /// Element `index` of numbers; 0 <= index < count().
  double number(std::size_t index) const;
  /// The only number; NaN if there is not exactly one.
  double scalar() const;
  /// A row of characters as UTF-8; empty for everything else.
  std::string text() const;
  /// Texts: of a cell array, of the rows of a matrix of characters, or of one text.
  std::vector<std::string> texts() const;
  std::string name() const;

  /// Names of the fields of a struct.
  std::vector<std::string> fields() const;
  /// The field `name` of element `index` of a struct; empty if the struct lacks it.
  MatArray field(const std::string& name, std::size_t index = 0) const;
  MatArray cell(std::size_t index) const;

 private:
  std::string characters(std::size_t first, std::size_t count, std::size_t stride) const;

  const matvar_t* array_ = nullptr;
};

/// The variables of a MAT file, all in memory.
class MatFile {
 public:
  /// Throws InputError if the file is cut, damaged, too large, or of another version.
  explicit MatFile(const std::string& path);
  const std::vector<MatArray>& variables() const { return variables_; }

 private:
  struct Closer {
    void operator()(_mat_t* file) const;
  };
  struct Freer {
    void operator()(matvar_t* array) const;
  };
  std::unique_ptr<_mat_t, Closer> file_;
  std::vector<std::unique_ptr<matvar_t, Freer>> arrays_;
  std::vector<MatArray> variables_;
};

}  // namespace condyle::host
