// SPDX-License-Identifier: Apache-2.0
// Turns drive and positions, each with its own times and rate, into the damping of chewing cycles.
//
//   1   point_identification.h identifies the point over `identification_s`, and for longer while
//       a test of it speaks: the baseline, and the drive's delay if that is to be fitted
//   2   cycle_damping.h steps from position to position, over the drive's samples between them; the
//       drive is linear between its samples, and a position waits for the next one
//
//   n         steps per sample of the drive, counted during 1
//   sigma^2   variance of a sample of the drive, as its own differences showed it during 1
//
// Drive noise: the drive at a position between two samples has the error of these, and no new one.
// cycle_damping.h takes it for one of its own; with n sigma^2 for each the noise of the drive's
// integral is again that of one sigma^2 per sample.
#pragma once

#include <optional>

#include "condyle/estimator/changes/cycle_damping.h"
#include "condyle/estimator/impedance/point_identification.h"
#include "condyle/estimator/sampled_interval.h"

namespace condyle {

/// A cycle and when it ended.
template <class Scalar>
struct TimedCycle {
  TimeNs end_ns = 0;
  CycleReport<Scalar> report;
};

/// Finds the baseline, then delivers cycle after cycle. Fixed size, no allocation; see above.
/// Times, gaps and delays are as in PointRegression.
template <class Scalar>
class CycleTimeline {
 public:
  /// All must be valid.
  CycleTimeline(const ImpedanceParameters& impedance, const WatchParameters& watch)
      : impedance_(impedance),
        watch_(watch),
        interval_(nanoseconds(-impedance.drive.delay_s),
                  nanoseconds(impedance.drive.longest_gap_s)),
        identification_(impedance) {}

  /// A measured drive (N), stamped `time_ns`. Each cycle that ends with it is passed to
  /// `sink(cycle)`, as a TimedCycle.
  template <class Sink>
  void add_drive(TimeNs time_ns, Scalar drive_N, Sink&& sink) {
    if (!damping_) identification_.add_drive(time_ns, drive_N);
    const SampleOrder order = interval_.add(time_ns);
    const TimeNs begin_ns = interval_.begin_ns(), end_ns = interval_.end_ns();
    if (order == SampleOrder::not_in_order) {
      if (damping_) ++counts_.drive_not_in_order;
      return;
    }
    if (order == SampleOrder::after_gap && damping_) {
      ++counts_.drive_gaps;
      damping_->interrupt();
    }
    if (order == SampleOrder::next) {
      if (damping_ && at_ns_ < begin_ns) damping_->drive(advance_to(begin_ns), end_N_);
      identified_ns_ += end_ns - begin_ns;
      begin_N_ = end_N_;
    } else {
      start_at(end_ns);
      begin_N_ = drive_N;
    }
    end_N_ = drive_N;
    ++drives_;
    take_waiting(sink);
    if (!damping_) begin_watch();
  }

  /// A position (m) with noise of standard deviation `sd_m`; NaN: it was due and is missing. If
  /// teeth or food may touch (ImpedanceParameters), the cycle is dropped.
  template <class Sink>
  void add_position(TimeNs time_ns, Scalar position_m, Scalar sd_m, Sink&& sink) {
    if (!damping_ && std::isfinite(position_m)) {
      identification_.add_position(time_ns, position_m);
    }
    if (interval_.has_sample() && time_ns < interval_.begin_ns()) {
      if (damping_) ++counts_.positions_too_early;
    } else if (waiting_.is_full()) {
      if (damping_) ++counts_.positions_dropped;
    } else {
      waiting_.add({time_ns, position_m, sd_m});
      if (interval_.has_sample()) take_waiting(sink);
    }
  }

  /// True once the baseline is known and cycles are delivered.
  bool is_watching() const { return damping_.has_value(); }
  /// The properties identified so far, or when the watch began.
  ImpedanceEstimate<Scalar> identified() const { return identification_.estimate(); }
  /// Counts of problems, in the identification and after it.
  DriveCounts counts() const {
    DriveCounts sum = identification_.counts();
    sum.drive_not_in_order += counts_.drive_not_in_order;
    sum.drive_gaps += counts_.drive_gaps;
    sum.positions_too_early += counts_.positions_too_early;
    sum.positions_dropped += counts_.positions_dropped;
    sum.positions_in_contact += counts_.positions_in_contact;
    return sum;
  }

 private:
  void start_at(TimeNs time_ns) {
    at_ns_ = time_ns;
    is_at_start_ = true;
  }

  // The time step to there.
  Scalar advance_to(TimeNs time_ns) {
    const Scalar T = static_cast<Scalar>(seconds(time_ns - at_ns_));
    at_ns_ = time_ns;
    return T;
  }

  Scalar drive_at(TimeNs time_ns) const {
    if (interval_.begin_ns() == interval_.end_ns()) return end_N_;
    return begin_N_ + interval_.share<Scalar>(time_ns) * (end_N_ - begin_N_);
  }

  // Takes the positions within the present interval.
  template <class Sink>
  void take_waiting(Sink&& sink) {
    waiting_.take_until(interval_.end_ns(),
                        [&](const WaitingPosition<Scalar>& position) { take(position, sink); });
  }

  template <class Sink>
  void take(const WaitingPosition<Scalar>& position, Sink&& sink) {
    if (position.time_ns < interval_.begin_ns()) {
      if (damping_) ++counts_.positions_too_early;
      return;
    }
    if (!damping_) {
      if (position.time_ns < interval_.end_ns()) ++between_;
      return;
    }
    if (position.time_ns < at_ns_ || (position.time_ns == at_ns_ && !is_at_start_)) {
      ++counts_.positions_too_early;
      return;
    }
    is_at_start_ = false;
    if (position.position_m > Scalar(impedance_.contact_above_m) ||
        position.position_m < Scalar(impedance_.contact_below_m)) {
      ++counts_.positions_in_contact;
      damping_->interrupt();
      at_ns_ = position.time_ns;
      return;
    }
    const Scalar drive_N = drive_at(position.time_ns);
    const CycleReport<Scalar> report =
        damping_->step(advance_to(position.time_ns), drive_N, position.position_m, position.sd_m);
    if (report.outcome != CycleOutcome::none) sink(TimedCycle<Scalar>{position.time_ns, report});
  }

  // Only after the identification has been judged: a model that does not hold is not a baseline.
  void begin_watch() {
    using std::sqrt;
    if (seconds(identified_ns_) < watch_.identification_s) return;
    const ImpedanceEstimate<Scalar> estimate = identification_.estimate();
    const ImpedanceLimit limit = estimate.mass_kg.limit;
    if (is_failure(limit) || !is_valid(baseline_of(estimate))) return;
    ImpedanceParameters impedance = impedance_;
    impedance.drive.noise_sd_N =
        static_cast<double>(estimate.drive_noise_sd_N) *
        sqrt(1 + static_cast<double>(between_) / static_cast<double>(drives_));
    damping_.emplace(baseline_of(estimate), impedance, watch_.cycles);
    start_at(interval_.end_ns());
    if (impedance_.delay == DelayModel::fitted) {  // then the fitted delay is subtracted too
      interval_.set_shift(nanoseconds(-static_cast<double>(estimate.plain.delay_s)));
      interval_.forget();
    }
  }

  ImpedanceParameters impedance_;
  WatchParameters watch_;
  SampledInterval interval_;  // of the drive, at the times of the force
  PointIdentification<Scalar> identification_;
  std::optional<CycleDamping<Scalar>> damping_;  // of the baseline, once that is known
  TimeNs identified_ns_ = 0;
  std::uint64_t drives_ = 0, between_ = 0;  // samples of the drive, positions between them
  TimeNs at_ns_ = 0;                        // the time of damping_
  bool is_at_start_ = false;                // no position was taken there
  Scalar begin_N_ = 0, end_N_ = 0;
  WaitingPositions<Scalar> waiting_;
  DriveCounts counts_;
};

}  // namespace condyle
