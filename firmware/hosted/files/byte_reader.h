// SPDX-License-Identifier: Apache-2.0
// Reads a file front to back in bounded memory, by lines or by bytes.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace condyle::host {

/// Reads one file or pipe in sequence. Errors are InputErrors that name the file.
class ByteReader {
 public:
  /// Longest line accepted.
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20;

  /// Opens `path`.
  explicit ByteReader(const std::string& path);

  /// The next bytes, not consumed: up to `count` (at most kLongestLine), fewer at the end of the
  /// file.
  std::string_view peek(std::size_t count);
  /// Consumes `count` bytes that were peeked.
  void skip(std::size_t count);
  /// From here on the file is UTF-16, and is returned as UTF-8. Bytes that are no UTF-16 give an
  /// InputError when they are read.
  void decode_utf16(bool is_big_endian);
  /// Next line without its end (LF or CR LF); false at the end of the file. Valid until the next
  /// call.
  bool next_line(std::string_view& line);

  /// Whether the line last returned had an end; the last one of a file may have none.
  bool is_line_ended() const { return is_line_ended_; }
  /// Number of the line last returned, from 1.
  std::uint64_t line_number() const { return line_number_; }
  /// Bytes consumed so far.
  std::uint64_t offset() const { return consumed_; }
  /// Share of the file consumed so far, 0 to 1; 0 for a pipe, whose size is unknown.
  double progress() const {
    return size_ > 0 ? static_cast<double>(consumed_) / static_cast<double>(size_) : 0;
  }
  const std::string& path() const { return path_; }

 private:
  static constexpr std::size_t kBufferSize = 2 * kLongestLine;

  void fill(std::size_t wanted);
  void fill_from_utf16();
  std::size_t read_into(char* to, std::size_t count);

  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::unique_ptr<char[]> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // unread bytes of the buffer
  bool at_end_ = false, is_line_ended_ = true;
  enum class Encoding { bytes, utf16_little, utf16_big } encoding_ = Encoding::bytes;
  std::string undecoded_;  // bytes of UTF-16
  std::uint64_t line_number_ = 0, consumed_ = 0, size_ = 0;
};

}  // namespace condyle::host
