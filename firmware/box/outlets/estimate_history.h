// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>

namespace condyle::box {

/// The latest estimates as lines of JSON, numbered from 1 since the service started, for readers
/// that each keep their own place.
class EstimateHistory {
 public:
  explicit EstimateHistory(std::size_t most_lines) : most_lines_(most_lines) {}

  void add(std::string line);

  /// Number of the newest line; 0: there is none.
  std::uint64_t newest() const;

  struct Line {
    std::uint64_t number = 0;  ///< 0: there is no newer line
    std::uint64_t missed = 0;  ///< lines after the requested place that are no longer kept
    std::shared_ptr<const std::string> text;
  };
  /// The line after number `place`, or the oldest one that is kept.
  Line after(std::uint64_t place) const;

 private:
  std::size_t most_lines_;
  mutable std::mutex mutex_;
  std::deque<std::shared_ptr<const std::string>> lines_;
  std::uint64_t newest_ = 0;
};

}  // namespace condyle::box
