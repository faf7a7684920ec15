// SPDX-License-Identifier: Apache-2.0
// The last samples and their results, for estimates of earlier instants.
//
// Each instant has a track for each of the two banks (motion_hypotheses.h). Once one bank is given
// up, the other's track is the instant's.
#pragma once

#include <algorithm>

#include "condyle/estimator/motion/fixed_lag.h"
#include "condyle/estimator/motion/motion_hypotheses.h"
#include "condyle/estimator/motion/recommended_estimate.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// One sample as one bank saw it.
template <class Step, int kMembers>
struct BankTrack {
  bool is_taken = false;
  bool is_restart = false;  ///< it is unrelated to earlier samples
  Array<Step, kMembers> members;
};

/// One sample and its results. `kKept`: false if no estimate waits for later samples.
template <class Scalar, int kAxes, bool kKept>
struct MotionInstant {
  using Bank = FilterBank<Scalar, kAxes>;
  using Track = BankTrack<typename Bank::Step, kKept ? Bank::kMostMembers : 1>;

  TimeNs time_ns = 0;
  bool time_valid = true;
  bool is_measured = false;  ///< a position was given
  bool has_state = false;
  bool is_first = false;  ///< there was no prediction
  bool is_open = false;   ///< both tracks are possible; otherwise that of `track` holds
  int track = 0;
  EventSet events;
  Array<Scalar, kAxes> position_m = {};
  Array<Scalar, kAxes> innovation_m = {};
  Array<Scalar, kAxes> innovation_variance_m2 = {};
  Array<Scalar, kAxes> rounding_variance_m2 = {};  ///< that no later sample takes from the position
  TransitionJacobian<Scalar> F;                    ///< from the previous sample
  Track tracks[2];

  /// The track of the bank `index`, if both are still possible.
  const Track& seen_by(int index) const { return tracks[is_open ? index : track]; }
  Track& seen_by(int index) { return tracks[is_open ? index : track]; }

  /// Fills in the measurement and how far it was from its prediction.
  void describe_measurement(RecommendedEstimate<Scalar>& estimate) const {
    Scalar nis = 0;
    bool has_nis = !is_first;
    for (int axis = 0; axis < kAxes; ++axis) {
      AxisEstimate<Scalar>& described = estimate.axes[axis];
      described.measured_position_m = position_m[axis];
      const Scalar variance_m2 = innovation_variance_m2[axis];
      has_nis = has_nis && variance_m2 > Scalar(0) && std::isfinite(variance_m2);
      if (!has_nis) continue;
      described.innovation_m = innovation_m[axis];
      described.innovation_sd_m = std::sqrt(variance_m2);
      nis += innovation_m[axis] * innovation_m[axis] / variance_m2;
    }
    if (has_nis) estimate.nis = nis;
  }
};

/// The last `kInstants` of them.
template <class Scalar, int kAxes, int kInstants>
class MotionInstants {
 public:
  using Instant = MotionInstant<Scalar, kAxes, (kInstants > 1)>;
  using Bank = typename Instant::Bank;
  using Smoothed = Array<Array<MotionMoments<Scalar>, kAxes>, Bank::kMostMembers>;

  /// The instant `back` samples before the newest.
  Instant& at(int back) { return instants_[(newest_ + kInstants - back) % kInstants]; }
  const Instant& at(int back) const { return instants_[(newest_ + kInstants - back) % kInstants]; }

  /// Makes room for a new instant.
  Instant& advance() {
    newest_ = (newest_ + 1) % kInstants;
    Instant& instant = at(0);
    instant.time_valid = true;
    instant.is_measured = instant.has_state = instant.is_first = instant.is_open = false;
    for (auto& track : instant.tracks) track.is_taken = track.is_restart = false;
    instant.F = white_jerk_jacobian(Scalar(0));
    return instant;
  }

  /// The last `samples` instants came from a frozen device: nothing is known there.
  void forget_frozen(int samples) {
    for (int back = 0; back < std::min(samples, kInstants); ++back) {
      Instant& instant = at(back);
      instant.events.add(Event::position_frozen);
      instant.events.add(Event::state_lost);
      instant.has_state = false;
      instant.is_first = true;
      for (auto& track : instant.tracks) {
        track.is_taken = false;
        track.is_restart = true;  // what comes before is unrelated to what comes after
      }
    }
  }

  /// The bank `kept` was right about all open instants. A sample that it did not use, but the other
  /// did, was an outlier.
  void settle(int kept) {
    for (int back = 0; back < kInstants; ++back) {
      Instant& instant = at(back);
      if (!instant.is_open) continue;
      instant.is_open = false;
      instant.track = kept;
      instant.events.add(Event::outlier_rejected,
                         !instant.tracks[kept].is_taken && instant.tracks[1 - kept].is_taken);
    }
  }

  /// Members of `bank`, of index `index`, `back` samples ago, smoothed by all samples since.
  void smooth(const Bank& bank, int index, int back, Smoothed& smoothed) const {
    for (int i = 0; i < bank.member_count(); ++i) {
      if (!bank.is_plausible(i)) continue;
      LaterEvidence<Scalar, kAxes> evidence;
      for (int j = 0; j < back; ++j) {
        const Instant& later = at(j);
        const auto& track = later.seen_by(index);
        if (track.is_restart) {
          evidence.forget();
        } else {
          if (track.is_taken) evidence.go_back_over_measurement(track.members[i]);
          evidence.go_back_over_step(later.F);
        }
      }
      const auto& step = at(back).seen_by(index).members[i];
      for (int axis = 0; axis < kAxes; ++axis) smoothed[i][axis] = evidence.smoothed(step, axis);
    }
  }

  /// Time from the instant `back` samples ago to the last sample since that the bank `index` took
  /// (s), or to its restart.
  Scalar later_s(int index, int back) const {
    Scalar since_s = 0, taken_s = 0;
    for (int j = back - 1; j >= 0; --j) {
      const auto& track = at(j).seen_by(index);
      if (track.is_restart) break;
      since_s += at(j).F.pv;
      if (track.is_taken) taken_s = since_s;
    }
    return taken_s;
  }

 private:
  int newest_ = 0;
  Array<Instant, kInstants> instants_;
};

}  // namespace condyle
