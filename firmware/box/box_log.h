// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "condyle/hal/clock.h"

namespace condyle::box {

/// Lines for the journal or a person, on the error output. At most five lines of a kind are written
/// in a minute; the next one contains the number of those suppressed. Call it from any thread but
/// the real-time one.
class BoxLog {
 public:
  /// A person reads no priorities, and nothing of the lowest one.
  enum class Reader : std::uint8_t { journal, person };

  explicit BoxLog(hal::Clock& clock, std::FILE* out = stderr, Reader reader = Reader::journal)
      : clock_(clock), out_(out), reader_(reader) {}

  /// Priorities as in sd-daemon(3).
  enum class Level : std::uint8_t { error = 3, warning = 4, notice = 5, info = 6 };

  /// `kind`: lines of one kind are counted together, such as "device".
  void say(Level level, std::string_view kind, const std::string& text);

 private:
  static constexpr int kMost = 5;
  static constexpr TimeNs kMinute_ns = 60 * kNanosecondsPerSecond;

  struct Kind {
    TimeNs begin_ns = 0;
    int said = 0;
    std::uint64_t withheld = 0;
  };

  hal::Clock& clock_;
  std::FILE* out_;
  const Reader reader_;
  std::mutex mutex_;
  std::map<std::string, Kind, std::less<>> kinds_;
};

}  // namespace condyle::box
