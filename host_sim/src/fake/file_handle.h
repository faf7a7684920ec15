// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "condyle/hal/clock.h"

namespace condyle::host::fake {

/// An open file that is closed with the object; -1: none.
class FileHandle {
 public:
  FileHandle() = default;
  explicit FileHandle(int file) : file_(file) {}
  ~FileHandle() { reset(); }
  FileHandle(FileHandle&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  FileHandle& operator=(FileHandle&& other) noexcept {
    std::swap(file_, other.file_);
    return *this;
  }

  int get() const { return file_; }
  bool is_open() const { return file_ >= 0; }
  void reset() {
    if (file_ >= 0) close(file_);
    file_ = -1;
  }

 private:
  int file_ = -1;
};

/// Waits until `file` is readable (true), or until `deadline_ns` of hal::SteadyClock or a signal.
inline bool wait_readable(int file, TimeNs deadline_ns) {
  hal::SteadyClock clock;
  const TimeNs wait_ns = std::max<TimeNs>(0, deadline_ns - clock.now_ns());
  const int whole_s = static_cast<int>(wait_ns / kNanosecondsPerSecond);
  const int rest_ns = static_cast<int>(wait_ns % kNanosecondsPerSecond);
  const timespec wait = {whole_s, rest_ns};
  pollfd item = {file, POLLIN, 0};
  return ppoll(&item, 1, &wait, nullptr) > 0;
}

}  // namespace condyle::host::fake
