// SPDX-License-Identifier: Apache-2.0
// The one interface to a facebow. Devices, recordings and simulations implement it, and readers of
// samples cannot distinguish them.
#pragma once

#include <limits>

#include "condyle/estimator/sample.h"
#include "condyle/hal/status.h"

namespace condyle::hal {

/// A deadline that never comes.
inline constexpr TimeNs kNoDeadline = std::numeric_limits<TimeNs>::max();

/// A source of samples. One thread uses it at a time.
class Facebow {
 public:
  /// Makes the source ready. ok, not_found, not_permitted or bad_report.
  virtual Status open() = 0;

  /// Next sample, waited for until `deadline_ns` of the clock the source was built with. `sample`
  /// is written only with ok. After disconnected, end or not_open the source must be opened again.
  virtual Status read(TimeNs deadline_ns, Sample& sample) = 0;

  /// Releases the source; may be called at any time, also twice.
  virtual void close() = 0;

 protected:
  ~Facebow() = default;  // not virtual: sources are never deleted through this interface
};

}  // namespace condyle::hal
