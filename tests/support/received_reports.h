// SPDX-License-Identifier: Apache-2.0
// A reader of the fake facebow's reports. It was written from the layout alone and shares nothing
// with the device, so that each checks the other.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>

namespace condyle::hil {

/// A checked report.
struct ReceivedReport {
  std::uint32_t counter = 0, time_us = 0;
  std::int16_t coordinates[9] = {};
};

/// Reads a report; empty if size, id or checksum is wrong.
inline std::optional<ReceivedReport> decode(const std::uint8_t* bytes, std::size_t size) {
  const auto word = [bytes](std::size_t at) {
    return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
  };
  const auto double_word = [&word](std::size_t at) {
    return word(at) | static_cast<std::uint32_t>(word(at + 2)) << 16;
  };
  if (size != 29 || bytes[0] != 1) return std::nullopt;
  std::uint16_t remainder = 0xffff;  // of the division by x^16 + x^12 + x^5 + 1
  for (std::size_t bit = 0; bit < 27 * 8; ++bit) {
    const bool next = (bytes[bit / 8] >> (7 - bit % 8) & 1) != 0;
    const bool top = (remainder & 0x8000) != 0;
    remainder = static_cast<std::uint16_t>(remainder << 1);
    if (top != next) remainder ^= 0x1021;
  }
  if (remainder != word(27)) return std::nullopt;
  ReceivedReport report;
  report.counter = double_word(1);
  report.time_us = double_word(5);
  for (std::size_t i = 0; i < 9; ++i) {
    report.coordinates[i] = static_cast<std::int16_t>(word(9 + 2 * i));
  }
  return report;
}

/// Counts what a reader sees.
struct Tally {
  std::uint64_t intact = 0, bad = 0, lost = 0, repeated = 0;
  std::uint64_t opened = 0, disconnections = 0, stalls = 0, failed_transfers = 0;
  std::optional<std::uint32_t> last_counter;

  void take(const std::uint8_t* bytes, std::size_t size) {
    const auto report = decode(bytes, size);
    if (!report) {
      ++bad;
      return;
    }
    ++intact;
    if (last_counter) {
      const std::uint32_t step = report->counter - *last_counter;
      if (step - 1 < 0x80000000U) {
        lost += step - 1;
      } else {
        ++repeated;
      }
    }
    last_counter = report->counter;
  }

  void print(const char* reader) const {
    std::printf(
        "{\"reader\":\"%s\",\"intact\":%llu,\"bad\":%llu,\"lost\":%llu,\"repeated\":%llu,"
        "\"opened\":%llu,\"disconnections\":%llu,\"stalls\":%llu,\"failed_transfers\":%llu,"
        "\"last_counter\":%lld}\n",
        reader, number(intact), number(bad), number(lost), number(repeated), number(opened),
        number(disconnections), number(stalls), number(failed_transfers),
        last_counter ? static_cast<long long>(*last_counter) : -1LL);
    std::fflush(stdout);
  }

 private:
  static unsigned long long number(std::uint64_t value) { return value; }
};

/// When a reader is done: usage READER LAST_COUNTER LIMIT_S ...
class Goal {
 public:
  Goal(std::uint32_t last_counter, double limit_s)
      : last_counter_(last_counter),
        limit_(std::chrono::steady_clock::now() +
               std::chrono::milliseconds(static_cast<long long>(limit_s * 1000))) {}
  bool is_reached(const Tally& tally) const {
    return tally.last_counter == last_counter_ || is_too_late();
  }
  bool is_too_late() const { return std::chrono::steady_clock::now() > limit_; }
  int exit_code(const Tally& tally) const { return tally.last_counter == last_counter_ ? 0 : 1; }

 private:
  std::uint32_t last_counter_;
  std::chrono::steady_clock::time_point limit_;
};

}  // namespace condyle::hil
