// SPDX-License-Identifier: Apache-2.0
// The machine that a test program runs on: a PC (hosted.cpp), or a bare-metal image whose debugger,
// here QEMU, has files (semihosted.cpp, semihosting.cpp). No heap.
#pragma once

#include <cstddef>
#include <cstdint>

namespace condyle::cross {

/// The program; returns its exit status. `arguments` are `count`, without the program's name.
int test_program(int count, const char* const* arguments);

/// Writes `text` to the standard output.
void print(const char* text);
/// The same in decimal.
void print(std::uint64_t number);

/// A file read or written from its beginning to its end.
class ByteFile {
 public:
  enum class Use { read, write };
  ByteFile(const char* path, Use use);
  /// Writes what is still to be written.
  bool close();
  bool is_open() const { return is_open_; }

  /// The next byte; false at the end.
  bool get(std::uint8_t& byte) {
    if (next_ == filled_) fill();
    if (next_ == filled_) return false;
    byte = bytes_[next_++];
    return true;
  }
  void put(std::uint8_t byte) {
    bytes_[filled_++] = byte;
    if (filled_ == sizeof bytes_) flush();
  }

 private:
  void fill();
  void flush();

  std::intptr_t handle_ = 0;
  bool is_open_ = false, is_good_ = true;
  std::size_t next_ = 0, filled_ = 0;
  std::uint8_t bytes_[16'384];
};

}  // namespace condyle::cross
