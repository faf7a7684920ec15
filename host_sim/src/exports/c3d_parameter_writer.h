// SPDX-License-Identifier: Apache-2.0
// The parameter section of a C3D file for Intel processors.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace condyle::host {

/// Appends a 16-bit word, the lower byte first.
void append_c3d_word(std::string& bytes, std::uint64_t value);
/// Appends a 32-bit floating-point number.
void append_c3d_float(std::string& bytes, double value);
/// Fills the last block of 512 bytes.
void fill_c3d_block(std::string& bytes);

/// Records of the section, one after the other.
class C3dParameterWriter {
 public:
  /// The next group; parameters that follow belong to it.
  void group(std::string_view name);
  /// One number, or a list of them, as 16-bit words.
  void word(std::string_view name, std::uint64_t value);
  void words(std::string_view name, const std::vector<std::uint64_t>& values);
  /// `shape`: dimensions, the fastest first; empty: one number.
  void floats(std::string_view name, const std::vector<int>& shape,
              const std::vector<double>& values);
  /// One text.
  void text(std::string_view name, const std::string& value);
  /// A list of texts; more than 255 continue in NAME2, NAME3 and so on.
  void texts(std::string_view name, const std::vector<std::string>& values);

  /// The whole section in blocks of 512 bytes. Empty if there are more than 255 of them.
  std::string section() const;

 private:
  // Type and shape, then `size` bytes of values, which the caller appends.
  void start(std::string_view name, int type, const std::vector<int>& shape, std::size_t size);

  int groups_ = 0;
  std::string records_;
};

}  // namespace condyle::host
