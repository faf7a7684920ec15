// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "condyle/hal/clock.h"

namespace condyle::host {

/// A line on the terminal with the progress of long work. Silent if the error output is not a
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
};

}  // namespace condyle::host
