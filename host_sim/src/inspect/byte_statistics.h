// SPDX-License-Identifier: Apache-2.0
// Properties of reports without a known meaning: rate, jitter, bytes that change, and likely
// counters or clocks.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "condyle/firmware/latency_histogram.h"
#include "condyle/hal/report/raw_report.h"

namespace condyle::host {

/// A number in a report that increases by about the same step with each report.
struct SteadyField {
  std::size_t offset_bytes = 0;
  std::size_t width_bytes = 0;
  bool is_big_endian = false;
  std::uint64_t step = 0;  ///< median; 1: a counter, otherwise perhaps a clock
};

/// Reports with one report number. Constant memory.
class ByteStatistics {
 public:
  void add(const hal::RawReport& report);

  std::uint64_t count() const { return count_; }
  /// The last report.
  const hal::RawReport& last() const { return last_; }
  /// Smallest and largest size so far (bytes).
  std::size_t smallest() const { return smallest_; }
  std::size_t largest() const { return largest_; }

  /// Reports per second, from their arrival times; 0 before the second report.
  double rate_Hz() const;
  /// Standard deviation of the intervals between arrivals (s).
  double jitter_s() const;
  /// Of the intervals between arrivals.
  const firmware::LatencyHistogram& intervals() const { return intervals_; }

  /// True if the byte was not the same in all reports.
  bool has_changed(std::size_t byte) const { return byte < largest_ && has_changed_[byte]; }
  /// Fields that increase steadily in at least 9 of 10 reports; of overlapping fields the
  /// steadiest, then the widest.
  std::vector<SteadyField> steady_fields() const;

 private:
  static constexpr std::size_t kWatched = 64;  // bytes that are searched for steady fields
  static constexpr std::size_t kForms = 5;     // 1 byte; 2 and 4, little- and big-endian

  // A candidate field: its most frequent step, by majority vote.
  struct Candidate {
    std::uint64_t value = 0, step = 0;
    std::uint64_t lead = 0;    // of the vote
    std::uint64_t steady = 0;  // reports with about this `step`
    std::uint64_t steps = 0;
  };

  void watch_fields(const hal::RawReport& report);

  hal::RawReport last_;
  std::uint64_t count_ = 0;
  std::size_t smallest_ = 0, largest_ = 0;
  TimeNs first_ns_ = 0;
  double mean_ns_ = 0, square_sum_ns2_ = 0;  // of the intervals (Welford)
  firmware::LatencyHistogram intervals_;
  std::array<bool, hal::kMaxReportSize> has_changed_{};
  std::array<std::array<Candidate, kForms>, kWatched> candidates_{};
};

/// "1-4, 9": the bytes that changed; "none".
std::string changed_text(const ByteStatistics& watch);
/// "500.0 Hz, every 2.000 ms +- 0.031 ms; p99 2.1 ms, at most 2.4 ms"; or a note that there are too
/// few reports.
std::string rate_text(const ByteStatistics& watch);
/// "byte 1 to 4, little-endian: increases by 1 per report; a counter?", for each field.
std::vector<std::string> steady_text(const ByteStatistics& watch);

}  // namespace condyle::host
