// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "hosted/files/byte_reader.h"

namespace condyle::host {

constexpr std::size_t kMatHeader = 128;
/// Of all variables of a MAT file, in memory.
constexpr std::uint64_t kMostMatBytes = std::uint64_t{1} << 30U;

/// True if `start`, at least the header, begins a MAT file of version 5 or 7.3.
bool looks_like_mat(std::string_view start);

/// Passes over the variables of a file before libmatio reads them: they must be whole, their
/// compressed bytes intact, and their size one that memory holds. libmatio allocates the parts that
/// a struct or a cell array states; so the file must have the bytes that they need at least.
class MatCheck {
 public:
  /// `path`: a MAT file of version 5 with at least its header.
  explicit MatCheck(const std::string& path);

  /// Their number. Throws InputError.
  std::size_t variables();

  /// Of the variables passed, inflated.
  std::uint64_t bytes() const { return bytes_; }

 private:
  [[noreturn]] void fail_cut() const;
  [[noreturn]] void fail_damaged(const std::string& what) const;
  void take(std::uint64_t count);
  void pass_plain(std::uint64_t count);
  void pass_compressed(std::uint64_t count);

  ByteReader reader_;
  bool swaps_ = false;
  std::size_t variables_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace condyle::host
