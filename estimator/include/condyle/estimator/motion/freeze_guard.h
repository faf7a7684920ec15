// SPDX-License-Identifier: Apache-2.0
// Keeps the repeats of a frozen device (frozen_detector.h) from an estimator of motion.
//
// A position repeated too often is not a measurement. Neither were the repeats used before this was
// noticed: their effect is undone.
#pragma once

#include "condyle/estimator/motion/frozen_detector.h"

namespace condyle {

/// See above. One object per run.
class FreezeGuard {
 public:
  /// Counts a sample, whatever becomes of it.
  void count() {
    if (run_samples_ > 0) ++run_samples_;
  }

  /// Judges `sample`, which is `measurement` to `estimator`: marks repeats, and withdraws those
  /// that a living device would not make. Leave out samples with a repeated time.
  template <class Estimator>
  void judge(const Sample& sample, typename Estimator::Measurement& measurement,
             Estimator& estimator) {
    const bool is_frozen = frozen_.add(sample);
    measurement.is_repeat = frozen_.repeats() > 0;
    if (frozen_.repeats() == 0) {
      run_samples_ = 0;
      return;
    }
    if (is_frozen && run_samples_ > 0) {
      estimator.forget_frozen(run_samples_ - 1);
      run_samples_ = 0;
    }
    if (is_frozen || frozen_.is_doubtful()) {
      measurement.events.add(is_frozen ? Event::position_frozen : Event::position_repeated);
      measurement.is_measured = false;
    } else if (run_samples_ == 0) {
      run_samples_ = 1;
    }
  }

 private:
  FrozenDetector frozen_;
  int run_samples_ = 0;  // since the first used repeat of the present run, that included
};

}  // namespace condyle
