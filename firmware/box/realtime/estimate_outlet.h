// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>

#include "box/realtime/box_estimate.h"
#include "condyle/firmware/latency_histogram.h"
#include "condyle/firmware/nonblocking.h"
#include "condyle/firmware/sensor_with_pose.h"

namespace condyle::box {

/// The estimator's health, from its last estimate.
struct EstimatorHealth {
  bool is_ready = false;       ///< there was an estimate in this run
  double noise_sd_m = 0;       ///< of the followed axis
  double mean_nis = 0;         ///< per axis, over about the last 200 samples; 1 if the model holds
  std::uint64_t rejected = 0;  ///< outliers, in all runs
  std::uint64_t not_finite = 0;  ///< unusable states or variances, in all runs
};

/// Takes the estimates of the one thread that makes them, and keeps what the status shows of them.
class EstimateOutlet {
 public:
  explicit EstimateOutlet(Axis followed) : followed_(followed) {}

  /// From here on, estimates belong to run number `run`, whose estimator is fresh.
  void begin_run(std::uint64_t run) {
    out_ = {};
    out_.run = run;
    forget();
  }
  /// Marks the health as unknown until the next estimate.
  void forget() {
    is_ready_.store(false, std::memory_order_relaxed);
    mean_nis_.store(1, std::memory_order_relaxed);
  }
  /// `arrival_ns`: of the report that led to it. `node`: set if a microcontroller made it.
  template <class Estimate>
  void publish(const Estimate& estimate, TimeNs arrival_ns,
               const NodeMark& node = {}) CONDYLE_NONBLOCKING;
  /// States that the microcontroller has no estimate in `run`.
  void publish_absence(std::uint64_t run) {
    BoxEstimate absence;
    absence.run = run;
    absence.node.state = NodeMark::State::away;
    (void)ring_.push(absence);
  }
  /// From receiving a report to its estimate in the ring.
  void note_latency(TimeNs latency_ns) { latency_.add(latency_ns); }

  /// For the one publishing thread.
  EstimateRing& ring() { return ring_; }

  // For any thread:
  EstimatorHealth health() const {
    return {.is_ready = is_ready_.load(std::memory_order_relaxed),
            .noise_sd_m = noise_sd_m_.load(std::memory_order_relaxed),
            .mean_nis = mean_nis_.load(std::memory_order_relaxed),
            .rejected = rejected_.load(std::memory_order_relaxed),
            .not_finite = not_finite_.load(std::memory_order_relaxed)};
  }
  /// Estimates of all runs.
  std::uint64_t count() const { return count_.load(std::memory_order_relaxed); }
  const firmware::LatencyHistogram& latency() const { return latency_; }

 private:
  void take(const RecommendedEstimate<double>& estimate) {
    static_cast<RecommendedEstimate<double>&>(out_.estimate) = estimate;
    out_.has_impedance = false;
  }
  void take(const DrivenEstimate<double>& estimate) {
    out_.estimate = estimate;
    out_.has_impedance = true;
  }
  static void raise(std::atomic<std::uint64_t>& counter) {
    counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  Axis followed_;
  EstimateRing ring_;
  firmware::LatencyHistogram latency_;
  std::atomic<bool> is_ready_ = false;
  std::atomic<double> noise_sd_m_ = 0, mean_nis_ = 0;
  std::atomic<std::uint64_t> rejected_ = 0, not_finite_ = 0, count_ = 0;
  BoxEstimate out_;
};

template <class Estimate>
void EstimateOutlet::publish(const Estimate& estimate, TimeNs arrival_ns,
                             const NodeMark& node) CONDYLE_NONBLOCKING {
  take(estimate);
  if constexpr (firmware::kHasPose<Estimate>) {
    out_.has_pose = true;
    out_.pose = estimate.pose;
  }
  out_.arrival_ns = arrival_ns;
  out_.node = node;
  ++out_.number;
  (void)ring_.push(out_);
  raise(count_);

  constexpr double kMemory = 200;
  const int axis = estimate.axis_count == 3 ? static_cast<int>(followed_) : 0;
  is_ready_.store(true, std::memory_order_relaxed);
  noise_sd_m_.store(estimate.axes[axis].noise_sd_m, std::memory_order_relaxed);
  if (std::isfinite(estimate.nis) && !is_unexpected(estimate.events)) {
    const double mean = mean_nis_.load(std::memory_order_relaxed);
    mean_nis_.store(mean + (estimate.nis / estimate.axis_count - mean) / kMemory,
                    std::memory_order_relaxed);
  }
  if (estimate.events.has(Event::outlier_rejected)) raise(rejected_);
  if (estimate.events.has(Event::estimate_not_finite) ||
      estimate.events.has(Event::variance_negative)) {
    raise(not_finite_);
  }
}

}  // namespace condyle::box
