// SPDX-License-Identifier: Apache-2.0
// Drive and positions, each at its own times and rate, in the order in which they happened.
//
// A position waits until the drive around it is known, and one sample of the drive more. Times are
// of one clock; those of the drive are taken back by its delay first. A drive whose time does not
// go on is left out; a gap in it, or a clock that is set back by as much, interrupts the
// identification.
//
//   u_k, T    drive at sample k (N), steps before and after it (s)
//
// Hold:        lines between the samples of a curved force cut its peaks by w^2 T^2 / 12, which
// would
//              be taken for less mass. So they go through u_k - T^2 u_k'' / 12, with u'' from the
//              neighbours: their mean over a step is then that of the force, to fourth order. The
//              noise stays white for what moves the point, which is slow against T.
#pragma once

#include <array>

#include "condyle/estimator/joint_identification.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// What was not as it should be.
struct DriveTimelineCounts {
  std::uint64_t drive_not_in_order = 0;    ///< samples of the drive that were left out
  std::uint64_t drive_gaps = 0;            ///< longer than the longest, either way
  std::uint64_t positions_too_early = 0;   ///< before the first drive, or within a gap
  std::uint64_t positions_dropped = 0;     ///< too many waited for the drive
  std::uint64_t positions_in_contact = 0;  ///< where teeth or food may touch
  std::uint64_t restarts = 0;           ///< drive and model did not explain the motion for seconds
  std::uint64_t positions_at_rest = 0;  ///< of a point that hardly moved: its place alone
};

/// Feeds a JointIdentification. Fixed size, no allocation.
template <class Scalar>
class DriveTimeline {
 public:
  /// `parameters` must be valid.
  explicit DriveTimeline(const JointParameters& parameters)
      : delay_ns_(nanoseconds(parameters.drive.delay_s)),
        longest_gap_ns_(nanoseconds(parameters.drive.longest_gap_s)),
        stage_(parameters) {}

  /// A measured drive (N), stamped `time_ns`.
  void add_drive(TimeNs time_ns, Scalar drive_N) {
    TimeNs force_time_ns = 0, step_ns = 0;
    const bool has_overflow = __builtin_sub_overflow(time_ns, delay_ns_, &force_time_ns) ||
                              __builtin_sub_overflow(force_time_ns, newest_.time_ns, &step_ns);
    if (has_newest_ && (has_overflow || step_ns > longest_gap_ns_ || step_ns < -longest_gap_ns_)) {
      ++counts_.drive_gaps;
      give(newest_, Scalar(0));
      interrupt();
    } else if (has_newest_ && step_ns <= 0) {
      ++counts_.drive_not_in_order;
      return;
    }
    const DriveSample sample{force_time_ns, drive_N};
    if (has_newest_) give(newest_, has_before_ ? curvature(before_, newest_, sample) : Scalar(0));
    has_before_ = has_newest_;
    before_ = newest_;
    newest_ = sample;
    has_newest_ = true;
  }

  /// A measured position (m) with noise of standard deviation `sd_m`.
  void add_position(TimeNs time_ns, Scalar position_m, Scalar sd_m) {
    if (has_drive_ && time_ns < begin_ns_) {
      ++counts_.positions_too_early;
    } else if (waiting_count_ == kMostWaiting) {
      ++counts_.positions_dropped;
    } else {
      waiting_[waiting_count_++] = {time_ns, position_m, sd_m};
      if (has_drive_) take_waiting();
    }
  }

  /// What is known now.
  JointEstimate<Scalar> estimate() const { return stage_.estimate(); }
  const DriveTimelineCounts& counts() const { return counts_; }

 private:
  // For a drive of 25 Hz and positions of 500 Hz, and some more.
  static constexpr std::size_t kMostWaiting = 64;
  struct Waiting {
    TimeNs time_ns;
    Scalar position_m, sd_m;
  };
  struct DriveSample {
    TimeNs time_ns = 0;
    Scalar drive_N = 0;
  };

  // Second derivative at `sample` (N/s^2).
  static Scalar curvature(const DriveSample& before, const DriveSample& sample,
                          const DriveSample& after) {
    const Scalar T0 = seconds_between(before.time_ns, sample.time_ns);
    const Scalar T1 = seconds_between(sample.time_ns, after.time_ns);
    const Scalar change_of_slope =
        (after.drive_N - sample.drive_N) / T1 - (sample.drive_N - before.drive_N) / T0;
    return Scalar(2) * change_of_slope / (T0 + T1);
  }

  // The drive is to go to `sample`.
  void give(const DriveSample& sample, Scalar curvature) {
    begin_ns_ = has_drive_ ? end_ns_ : sample.time_ns;
    end_ns_ = sample.time_ns;
    has_drive_ = true;
    const Scalar T = seconds_between(begin_ns_, end_ns_);
    stage_.drive(T, sample.drive_N - T * T * curvature / Scalar(12), curvature);
    take_waiting();
  }

  static Scalar seconds_between(TimeNs begin_ns, TimeNs end_ns) {
    return static_cast<Scalar>(seconds(end_ns - begin_ns));
  }

  // Takes the positions within the present interval.
  void take_waiting() {
    std::size_t taken = 0;
    for (; taken < waiting_count_ && waiting_[taken].time_ns <= end_ns_; ++taken) {
      const Waiting& position = waiting_[taken];
      if (position.time_ns < begin_ns_) {
        ++counts_.positions_too_early;
        continue;
      }
      const Scalar share = begin_ns_ == end_ns_ ? Scalar(1)
                                                : seconds_between(begin_ns_, position.time_ns) /
                                                      seconds_between(begin_ns_, end_ns_);
      count(stage_.measure(share, position.position_m, position.sd_m).outcome);
    }
    for (std::size_t i = taken; i < waiting_count_; ++i) waiting_[i - taken] = waiting_[i];
    waiting_count_ -= taken;
  }

  void count(JointOutcome outcome) {
    if (outcome == JointOutcome::paused) ++counts_.positions_in_contact;
    if (outcome == JointOutcome::held) ++counts_.positions_at_rest;
    if (outcome == JointOutcome::refused) ++counts_.restarts;
  }

  void interrupt() {
    stage_.interrupt();
    has_drive_ = has_newest_ = false;
  }

  TimeNs delay_ns_, longest_gap_ns_;
  JointIdentification<Scalar> stage_;
  DriveSample before_, newest_;  // the newest has not been given yet
  bool has_before_ = false, has_newest_ = false;
  bool has_drive_ = false;
  TimeNs begin_ns_ = 0, end_ns_ = 0;  // of the drive's present interval
  std::array<Waiting, kMostWaiting> waiting_{};
  std::size_t waiting_count_ = 0;
  DriveTimelineCounts counts_;
};

}  // namespace condyle
