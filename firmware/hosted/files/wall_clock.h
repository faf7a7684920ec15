// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "condyle/estimator/sample.h"

namespace condyle::host {

/// Time since 1970-01-01 UTC by the wall clock. That may be set at any time, so use it for names
/// and headers only.
inline TimeNs wall_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace condyle::host
