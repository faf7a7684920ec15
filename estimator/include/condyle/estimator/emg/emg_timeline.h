// SPDX-License-Identifier: Apache-2.0
// Puts EMG and positions, each with its own times and rate, into order of time.
//
//   excitation -> activation -> force along the followed axis (muscle_force.h) -> identification
//
// The activation follows the mean of two neighbouring excitations. The force is computed at the
// identification's own position and velocity at the sample's instant. A position waits until the
// EMG around it is known. Times are of one clock; the lag of the force is first added to those of
// the EMG. EMG whose time does not advance, or with a value that is not finite, is left out. A gap
// in the EMG, or a position that the jaw cannot reach, interrupts the identification.
#pragma once

#include "condyle/estimator/emg/emg_identification.h"
#include "condyle/estimator/sampled_interval.h"

namespace condyle {

/// The muscles whose EMG is measured, and the jaw they drive.
struct MuscleSet {
  JawGeometry jaw;
  std::array<MuscleParameters, kMostMuscles> muscle;
  std::size_t count = 0;
};

/// Counts of problems.
struct EmgTimelineCounts {
  std::uint64_t emg_not_in_order = 0;     ///< samples that were left out
  std::uint64_t emg_not_finite = 0;       ///< likewise
  std::uint64_t emg_gaps = 0;             ///< longer than the longest, either way
  std::uint64_t positions_too_early = 0;  ///< before the first EMG, or within a gap
  std::uint64_t positions_dropped = 0;    ///< too many were waiting for the EMG
  std::uint64_t out_of_reach = 0;         ///< of the jaw
};

/// Feeds an EmgIdentification. Fixed size, no allocation.
template <class Scalar>
class EmgTimeline {
 public:
  using Excitations = std::array<Scalar, kMostMuscles>;

  /// `parameters` must be valid. `lag_s`: further lag of the force behind the EMG, negative for a
  /// delayed envelope.
  EmgTimeline(const EmgParameters& parameters, const MuscleSet& muscles, double lag_s = 0)
      : muscles_(muscles),
        interval_(nanoseconds(parameters.lag_s + lag_s), nanoseconds(parameters.longest_gap_s)),
        stage_(parameters, muscles.count) {}

  /// Excitations, share of the maximum, stamped `time_ns`; below 0 they count as 0.
  void add_emg(TimeNs time_ns, const Excitations& measured) {
    Excitations excitation{};
    for (std::size_t n = 0; n < muscles_.count; ++n) {
      if (!(measured[n] - measured[n] == Scalar(0))) {
        ++counts_.emg_not_finite;
        return;
      }
      excitation[n] = measured[n] > Scalar(0) ? measured[n] : Scalar(0);
    }
    const SampleOrder order = interval_.add(time_ns);
    if (order == SampleOrder::not_in_order) {
      ++counts_.emg_not_in_order;
      return;
    }
    if (order == SampleOrder::after_gap) {
      ++counts_.emg_gaps;
      stage_.interrupt();
    }
    if (order != SampleOrder::next) activation_ = excitation_ = excitation;
    const Scalar T = interval_.length_s<Scalar>();
    for (std::size_t n = 0; n < muscles_.count; ++n) {
      const Scalar mean = (excitation_[n] + excitation[n]) / Scalar(2);
      activation_[n] = activation_after(activation_[n], mean, T);
    }
    excitation_ = excitation;
    stage_.drive(T, forces(T));
    take_waiting();
  }

  /// A measured position (m) with noise of standard deviation `sd_m`.
  void add_position(TimeNs time_ns, Scalar position_m, Scalar sd_m) {
    if (interval_.has_sample() && time_ns < interval_.begin_ns()) {
      ++counts_.positions_too_early;
    } else if (waiting_.is_full()) {
      ++counts_.positions_dropped;
    } else if (!muscles_.jaw.reaches(position_m)) {
      ++counts_.out_of_reach;
    } else {
      waiting_.add({time_ns, position_m, sd_m});
      if (interval_.has_sample()) take_waiting();
    }
  }

  /// When the force of EMG stamped `time_ns` acts; give earlier positions before it.
  TimeNs force_time_ns(TimeNs time_ns) const { return time_ns + interval_.shift_ns(); }
  /// The present results.
  EmgEstimate<Scalar> estimate() const { return stage_.estimate(); }
  const EmgTimelineCounts& counts() const { return counts_; }
  /// The muscles' latest forces (N) along the followed axis, of gain 1.
  const typename EmgIdentification<Scalar>::Forces& forces_N() const { return forces_; }

 private:
  // Forces now, `T` s after the previous ones.
  const typename EmgIdentification<Scalar>::Forces& forces(Scalar T) {
    auto place = stage_.complete(T);
    if (!place.is_known) {
      place = {waiting_.is_empty() ? Scalar(0) : waiting_.first().position_m, Scalar(0), false};
    }
    if (!muscles_.jaw.reaches(place.position_m)) {
      ++counts_.out_of_reach;
      stage_.interrupt();
      place = {};
    }
    const Scalar q = muscles_.jaw.coordinate_at(place.position_m);
    const Scalar q_rate = place.velocity_m_s / muscles_.jaw.slope(q);
    for (std::size_t n = 0; n < muscles_.count; ++n) {
      forces_[n] = followed_force_N(muscles_.jaw, muscles_.muscle[n], activation_[n], q, q_rate);
    }
    return forces_;
  }

  // Takes the positions within the present interval.
  void take_waiting() {
    waiting_.take_until(interval_.end_ns(), [this](const WaitingPosition<Scalar>& position) {
      if (position.time_ns < interval_.begin_ns()) {
        ++counts_.positions_too_early;
        return;
      }
      const Scalar share = interval_.share<Scalar>(position.time_ns);
      (void)stage_.measure(share, position.position_m, position.sd_m);
    });
  }

  MuscleSet muscles_;
  SampledInterval interval_;  // of the EMG, at the times of its force
  EmgIdentification<Scalar> stage_;
  Excitations excitation_{}, activation_{};
  typename EmgIdentification<Scalar>::Forces forces_{};
  WaitingPositions<Scalar> waiting_;
  EmgTimelineCounts counts_;
};

}  // namespace condyle
