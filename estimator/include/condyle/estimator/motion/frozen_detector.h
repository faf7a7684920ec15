// SPDX-License-Identifier: Apache-2.0
// Detects a frozen device: it repeats its last coordinates at new times.
//
//   repeat  a sample whose coordinates are the last sample's, bit for bit
//   r       length of the present run of repeats
//   f       probability of a repeat after a repeat while the device lives
//
// A living device also repeats itself, when it rounds and the jaw rests. A repeat is frozen once
// its run is too improbable for a living device:
//   max(f, 0.01)^r < 1e-6,    f as it was when the run began:
// the fourth repeat of a noisy signal, the twentieth if every second sample at rest is a repeat.
// It is doubtful, and better not used, from 0.02 on: the first repeat of a noisy signal, the sixth
// if every second sample is one.
//
//   f = (10 g + a) / (10 + n)
//   n, a    samples after a repeat, and those of them that were repeats
//   g       share of repeats among the samples after a change: what f is without evidence
// f is learned at rest, where repeats occur; motion, which has none, does not dilute it.
// All are forgotten exponentially over 500 changes; g starts from 1/2 with the weight of four
// samples. Of a run, the repeats that are not frozen teach, and the first ten in any case: a rest
// longer than those before looks frozen, and would for ever if it taught nothing.
//
// What follows from that, and its limits:
// - Rest after motion, with a change every n samples: each run is called frozen from the fourth
//   repeat or later, until f has grown. The last such run of n = 10, 30, 100, 1000 begins 0, 30,
//   300, 7000 samples into the rest.
// - Chewing and resting in turn, rounded to 10 um, 60 Hz and 200 Hz, share of the rest called
//   frozen: 0.02 % with noise of 3 um, 0.8 % and 0.2 % with 2 um, 15 % and 10 % with 1 um.
// - Coordinates that do not change at all at rest cannot be told from a frozen device. They are
//   called frozen, until such rests have taught an f that hides freezes as long as they are.
// - What f has learned from rest delays the notice of a freeze: rounded to 10 um with noise of 3 um
//   to the 8th to 45th repeat.
// - A freeze teaches too: the next one is noticed at the 18th repeat right after it, at the 7th
//   after 1000 changes, at the fourth after 2000. Ten of them 300 changes apart take it beyond 100.
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
/// A run that is less probable than this is doubtful.
inline constexpr double kDoubtfulProbability = 0.02;

/// See the model above. No allocation, constant time.
class FrozenDetector {
 public:
  /// Takes the next sample's coordinates, in any unit, up to nine; further ones are ignored. True
  /// if the sample is frozen; never for the first sample that differs from the previous one. A
  /// coordinate that is not finite equals nothing, and teaches nothing. Leave out samples with a
  /// repeated time: they come from the transport.
  [[nodiscard]] bool add(std::span<const double> coordinates) {
    coordinates = coordinates.first(std::min(coordinates.size(), kMost));
    const bool is_finite = std::all_of(coordinates.begin(), coordinates.end(),
                                       [](double value) { return std::isfinite(value); });
    const bool is_comparable = is_finite && count_ > 0 && coordinates.size() == count_;
    if (is_comparable && std::equal(coordinates.begin(), coordinates.end(), last_, same_bits)) {
      return add_repeat();
    }
    if (is_comparable) learn_from_run();
    std::copy(coordinates.begin(), coordinates.end(), last_);
    count_ = is_finite ? coordinates.size() : 0;
    teaching_ = repeats_ = 0;
    run_probability_ = 1;
    run_rate_ = std::max(repeat_rate(), kSmallestRate);
    return false;
  }

  /// Takes all coordinates of `sample`; one without a position counts as not finite.
  [[nodiscard]] bool add(const Sample& sample) {
    return add(
        std::span(sample.coordinates, sample.position_valid ? coordinate_count(sample.kind) : 0));
  }

  /// Repeats up to the last sample, that one included; 0 if it differed from the previous one.
  int repeats() const { return repeats_; }
  /// True if the last sample was a repeat that a living device seldom makes.
  bool is_doubtful() const { return run_probability_ < kDoubtfulProbability; }

  /// f as learned so far; from 0 to 1.
  double repeat_rate() const {
    return (kPriorWeight * rate_after_change_ + repeated_after_repeat_) /
           (kPriorWeight + after_repeat_);
  }

 private:
  static constexpr std::size_t kMost = 9;
  static constexpr double kMemory = 500;
  static constexpr double kPriorWeight = 10;
  static constexpr double kSmallestRate = 0.01;
  static constexpr int kTaughtRepeats = 10;
  static constexpr int kMostRepeats = 1'000'000'000;

  // Not ==, because a change from 0 to -0 shows that the device lives.
  static bool same_bits(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  }

  bool add_repeat() {
    if (teaching_ == 0) learn_after_change(1);
    repeats_ = std::min(repeats_ + 1, kMostRepeats);
    run_probability_ *= run_rate_;
    const bool is_frozen = run_probability_ < kFrozenProbability;
    if (!is_frozen || teaching_ < kTaughtRepeats) ++teaching_;
    return is_frozen;
  }

  void learn_after_change(double repeated) {
    weight_ = std::min(weight_ + 1, kMemory);
    rate_after_change_ += (repeated - rate_after_change_) / weight_;
  }

  // Called at the end of a run, which may be empty.
  void learn_from_run() {
    if (teaching_ == 0) learn_after_change(0);
    after_repeat_ += teaching_;
    repeated_after_repeat_ += std::max(teaching_ - 1, 0);
    after_repeat_ *= 1 - 1 / kMemory;
    repeated_after_repeat_ *= 1 - 1 / kMemory;
  }

  double rate_after_change_ = 0.5, weight_ = 4;          // g
  double after_repeat_ = 0, repeated_after_repeat_ = 0;  // n, a
  double last_[kMost] = {};
  std::size_t count_ = 0;  // 0: nothing to compare with
  int repeats_ = 0;        // of the present run,
  int teaching_ = 0;       // and those that teach
  double run_probability_ = 1, run_rate_ = 0.5;
};

}  // namespace condyle
