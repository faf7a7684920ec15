// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "condyle/hal/clock.h"

namespace condyle::host {

/// A line on the terminal that says how far long work is. Silent where the error output is no
/// terminal, and for the first second.
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
