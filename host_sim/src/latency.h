// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "condyle/estimator/sample.h"

namespace condyle::host {

/// From a report's arrival to its estimate. Constant memory: a histogram with steps of 5 %.
class Latency {
 public:
  void add(TimeNs latency_ns);
  /// Latency (ns, to 5 %) that the share `quantile` does not exceed.
  double quantile_ns(double quantile) const;
  TimeNs largest_ns() const { return largest_ns_; }
  std::uint64_t count() const { return count_; }
  /// "p50 12 us, p99 30 us, at most 800 us".
  std::string words() const;

 private:
  static constexpr std::size_t kBins = 512;  // from 100 ns on, then 5 % more each

  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  TimeNs largest_ns_ = 0;
};

}  // namespace condyle::host
