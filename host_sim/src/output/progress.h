// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <string>

#include "condyle/hal/clock.h"

namespace condyle::host {

/// A line on the terminal with the progress of long work, and after some seconds with the time that
/// is left at the pace of the last half minute. Silent if the error output is not a
/// terminal, and in the first second.
class Progress {
 public:
  Progress(std::string what, hal::Clock& clock, unsigned calls_between_looks = 64);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `share`: 0 to 1. Cheap enough for every sample.
  void show(double share);

 private:
  std::string what_;
  hal::Clock& clock_;
  bool is_terminal_;
  bool shown_ = false;
  unsigned calls_between_looks_;  // at the clock
  unsigned calls_ = 0;
  TimeNs next_ns_;
  struct Look {
    TimeNs time_ns;
    double share;
  };
  std::deque<Look> looks_;
};

/// "about 3 min left": of work whose share grew from `before` to `now` in `elapsed_s`. Empty if the
/// pace is not known yet.
std::string time_left_text(double before, double now, double elapsed_s);

}  // namespace condyle::host
