// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "condyle/estimator/sample.h"

namespace condyle::firmware {

/// Durations recorded by one thread and read by any, in constant memory. A value is resolved to
/// 1/16 of itself: each doubling has 16 bins (as in HdrHistogram, https://hdrhistogram.org).
class LatencyHistogram {
 public:
  static constexpr std::size_t kBins = 16 * 41;  // up to 2^44 ns, five hours

  /// For the writer. Negative durations count as 0.
  void add(TimeNs latency_ns) {
    const auto latency = static_cast<std::uint64_t>(std::max<TimeNs>(latency_ns, 0));
    raise(bins_[bin_of(latency)]);
    raise(count_);
    if (latency_ns > largest_ns_.load(std::memory_order_relaxed)) {
      largest_ns_.store(latency_ns, std::memory_order_relaxed);
    }
  }

  std::uint64_t count() const { return count_.load(std::memory_order_relaxed); }
  TimeNs largest_ns() const { return largest_ns_.load(std::memory_order_relaxed); }
  std::uint64_t in_bin(std::size_t bin) const { return bins_[bin].load(std::memory_order_relaxed); }

  /// Smallest duration (ns) of `bin`.
  static constexpr TimeNs bin_begin_ns(std::size_t bin) {
    if (bin < 32) return static_cast<TimeNs>(bin);
    const std::size_t octave = bin / 16 - 1;
    return static_cast<TimeNs>(std::uint64_t{16 + bin % 16} << octave);
  }

  /// The `quantile` of the durations (ns), as the upper end of its bin; 0 if there are none.
  TimeNs quantile_ns(double quantile) const {
    const double wanted = quantile * static_cast<double>(count());
    double seen = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      seen += static_cast<double>(in_bin(i));
      if (seen > 0 && seen >= wanted) return std::min(bin_begin_ns(i + 1), largest_ns());
    }
    return largest_ns();
  }

 private:
  static constexpr std::size_t bin_of(std::uint64_t latency_ns) {
    std::size_t octave = 0;
    while (latency_ns >> octave >= 32) ++octave;
    return std::min(16 * octave + static_cast<std::size_t>(latency_ns >> octave), kBins - 1);
  }
  static void raise(std::atomic<std::uint64_t>& counter) {
    counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  std::array<std::atomic<std::uint64_t>, kBins> bins_{};
  std::atomic<std::uint64_t> count_ = 0;
  std::atomic<TimeNs> largest_ns_ = 0;
};
// Also where std::size_t has 32 bits.
static_assert(LatencyHistogram::bin_begin_ns(LatencyHistogram::kBins - 1) == TimeNs{31} << 39);

}  // namespace condyle::firmware
