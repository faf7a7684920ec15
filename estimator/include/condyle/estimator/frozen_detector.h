// SPDX-License-Identifier: Apache-2.0
// Notices a device that has frozen: it repeats its last coordinates at new times.
//
//   repeat  a sample whose coordinates are the last sample's, bit for bit
//   r       length of the present run of repeats
//   f       probability of a repeat while the device lives
//
// A living device also repeats itself, where it rounds and the jaw rests. Were its repeats
// independent of each other, a run of r would have the probability f^r; a repeat is frozen once
//   max(f, 0.01)^r < 1e-6,    f as it was when the run began:
// the fourth repeat of a noisy signal, the twentieth where every second sample is a repeat.
// f is the mean over the last 500 samples or so (exponential memory); it starts from 1/2 with the
// weight of four samples. Frozen repeats are not the living device's, so only the first 100 of a
// run teach f. They must teach: repeats are not independent, a jaw rests after it has moved, and a
// rest that looks frozen to the f of the motion would look so for ever.
//
// What follows from that, and its limits:
// - Rest after motion, with a change every n samples: each run is called frozen from the fourth
//   repeat or later, until f has grown. The last such run of n = 10, 30, 100, 1000 begins 130, 510,
//   1000, 16000 samples into the rest.
// - Coordinates that do not change at all at rest (rounding coarser than the noise) cannot be told
//   from a frozen device: they are called frozen until they change.
// - A freeze teaches too: one of 100 repeats or more leaves f at 0.18, and the next is noticed at
//   the ninth repeat, until that f is forgotten (half of it in 350 samples).
// - In the first seconds, before f has been learned, a freeze is noticed at the twentieth repeat.
// - A freeze of fewer repeats than these is not noticed.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "condyle/estimator/sample.h"

namespace condyle {

/// A run of repeats that is less probable than this for a living device is frozen.
inline constexpr double kFrozenProbability = 1e-6;

/// See the model above. No allocation, constant time.
class FrozenDetector {
 public:
  /// Takes the next sample's coordinates, in any unit, up to nine; further ones are not looked at.
  /// True where the sample is frozen; never the first sample that differs from the one before. A
  /// coordinate that is not finite equals nothing, and teaches nothing. Leave out samples whose
  /// time repeats: they are the transport's.
  [[nodiscard]] bool add(std::span<const double> coordinates) {
    coordinates = coordinates.first(std::min(coordinates.size(), kMost));
    const bool is_finite = std::all_of(coordinates.begin(), coordinates.end(),
                                       [](double value) { return std::isfinite(value); });
    const bool is_comparable = is_finite && count_ > 0 && coordinates.size() == count_;
    if (is_comparable && std::equal(coordinates.begin(), coordinates.end(), last_, same_bits)) {
      return add_repeat();
    }
    if (is_comparable) learn(0);
    std::copy(coordinates.begin(), coordinates.end(), last_);
    count_ = is_finite ? coordinates.size() : 0;
    run_ = 0;
    run_probability_ = 1;
    run_rate_ = std::max(rate_, kSmallestRate);
    return false;
  }

  /// Takes all coordinates of `sample`; one without a position counts as not finite.
  [[nodiscard]] bool add(const Sample& sample) {
    return add(
        std::span(sample.coordinates, sample.position_valid ? coordinate_count(sample.kind) : 0));
  }

  /// f, the share of repeats that has been learned.
  double repeat_rate() const { return rate_; }

 private:
  static constexpr std::size_t kMost = 9;
  static constexpr double kMemory_samples = 500;
  static constexpr double kSmallestRate = 0.01;
  static constexpr int kTaughtRepeats = 100;

  // Not ==: a change from 0 to -0 is a sign of life.
  static bool same_bits(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  }

  bool add_repeat() {
    run_probability_ *= run_rate_;
    const bool is_frozen = run_probability_ < kFrozenProbability;
    run_ = std::min(run_ + 1, kTaughtRepeats + 1);
    if (!is_frozen || run_ <= kTaughtRepeats) learn(1);
    return is_frozen;
  }

  void learn(double repeated) {
    weight_ = std::min(weight_ + 1, kMemory_samples);
    rate_ += (repeated - rate_) / weight_;
  }

  double rate_ = 0.5, weight_ = 4;
  double last_[kMost] = {};
  std::size_t count_ = 0;  // 0: there is nothing to compare with
  int run_ = 0;            // counted only as far as it matters
  double run_probability_ = 1, run_rate_ = 0.5;
};

}  // namespace condyle
