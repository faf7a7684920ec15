// SPDX-License-Identifier: Apache-2.0
// Messages of ROS 2 in plain CDR, little endian (OMG DDS-RTPS 2.2, 10.2): after four bytes of head,
// each number is aligned to its size.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "condyle/estimator/sample.h"

namespace condyle::host {

/// A message being written.
class CdrWriter {
 public:
  /// Begins another message.
  void begin() { bytes_.assign({0, 1, 0, 0}); }
  std::span<const std::uint8_t> bytes() const { return bytes_; }

  void number(std::uint8_t value) { bytes_.push_back(value); }
  void number(std::uint32_t value) { append(value, sizeof value); }
  void number(std::int32_t value) { append(static_cast<std::uint32_t>(value), sizeof value); }
  void number(double value) { append(std::bit_cast<std::uint64_t>(value), sizeof value); }
  void text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    bytes_.push_back(0);
  }
  /// builtin_interfaces/Time; `time_ns` must be within int32 seconds.
  void time(TimeNs time_ns) {
    TimeNs second = time_ns / kNanosecondsPerSecond, rest = time_ns % kNanosecondsPerSecond;
    if (rest < 0) --second, rest += kNanosecondsPerSecond;
    number(static_cast<std::int32_t>(second));
    number(static_cast<std::uint32_t>(rest));
  }

 private:
  void append(std::uint64_t value, std::size_t size) {
    while ((bytes_.size() - kHead) % size != 0) bytes_.push_back(0);
    for (std::size_t i = 0; i < size; ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }

  static constexpr std::size_t kHead = 4;
  std::vector<std::uint8_t> bytes_;
};

/// Reads a message. What is missing reads as zero or empty, and `ok()` is false from then on.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    ok_ = bytes.size() >= kHead && bytes[0] == 0 && bytes[1] == 1;
  }
  bool ok() const { return ok_; }

  std::uint8_t number8() { return static_cast<std::uint8_t>(take(1)); }
  std::uint32_t number32() { return static_cast<std::uint32_t>(take(4)); }
  double number64() { return std::bit_cast<double>(take(8)); }
  std::string_view text() {
    const std::size_t size = number32();
    if (!ok_ || size == 0 || size > bytes_.size() - at_) {
      ok_ = ok_ && size == 0;
      return {};
    }
    const std::string_view found(reinterpret_cast<const char*>(bytes_.data() + at_), size - 1);
    at_ += size;
    return found;
  }
  TimeNs time() {
    const auto second = static_cast<std::int32_t>(number32());
    return second * kNanosecondsPerSecond + static_cast<TimeNs>(number32());
  }

 private:
  std::uint64_t take(std::size_t size) {
    while ((at_ - kHead) % size != 0) ++at_;
    if (!ok_ || at_ > bytes_.size() || size > bytes_.size() - at_) {
      ok_ = false;
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value |= std::uint64_t{bytes_[at_++]} << (8 * i);
    return value;
  }

  static constexpr std::size_t kHead = 4;
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = kHead;
  bool ok_ = false;
};

}  // namespace condyle::host
