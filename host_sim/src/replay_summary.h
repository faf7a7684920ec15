// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "condyle/estimator/published_cascade.h"
#include "condyle/estimator/sample.h"

namespace condyle::host {

/// Collects what is said at the end of a replay. Constant memory.
class ReplaySummary {
 public:
  explicit ReplaySummary(const PublishedParameters& parameters) : parameters_(parameters) {}

  void add(const Sample& sample, const PublishedEstimate<double>& estimate);

  /// Steps that differ from the sample time by more than 1 %, of all steps.
  std::uint64_t uneven_steps() const { return uneven_steps_; }
  std::uint64_t steps() const { return steps_; }
  double shortest_step_s() const { return seconds(shortest_step_ns_); }
  double longest_step_s() const { return seconds(longest_step_ns_); }

  /// The summary in words, with units, uncertainties and provenance.
  std::string text() const;

 private:
  struct Mean {
    double sum = 0;
    std::uint64_t count = 0;
    void add(double value) {
      if (!std::isfinite(value)) return;
      sum += value;
      ++count;
    }
  };

  PublishedParameters parameters_;
  std::uint64_t samples_ = 0, steps_ = 0, uneven_steps_ = 0;
  std::optional<TimeNs> previous_time_ns_;  // of the last accepted sample
  TimeNs duration_ns_ = 0;
  TimeNs shortest_step_ns_ = 0, longest_step_ns_ = 0;
  Mean innovation_squared_, motion_nis_, friction_nis_, mass_nis_;
  EventCounts events_;
  // The last with values, and when.
  PublishedEstimate<double> last_;
  std::optional<TimeNs> last_time_ns_;
};

}  // namespace condyle::host
