// SPDX-License-Identifier: Apache-2.0
// Along one axis: the noise that each member of a bank of filters estimates, and its weight.
//
//   nu, S   a member's innovation (m), and its variance in units of R
//   R_i     variance of the noise (m^2) that member i makes out
//   <>      mean over the last n samples, older ones forgotten exponentially
//
// Noise.     For a given r the likelihood is largest at R_i = <nu^2 / S>: a mean of positive
//            numbers, held between floor and ceiling; the floor is at least step^2 / 12 if the
//            positions are rounded (rounding_step.h). Each nu^2 / S counts at most huber^2 R_i, so
//            that glitches do not become noise.
// Weights.   log w_i = max(long_i - max long, -kLongScoreFloor) + short_i, up to a constant:
//            long_i    log likelihood over the memory, -n/2 (log R_i + <log S_i>), tempered: jaw
//                      motion is not white jerk, innovations are correlated, and n of them count as
//                      kIndependentShare n
//            short_i   log likelihood of about the last kShortMemory samples,
//                      -1/2 sum min(log R_i S_i + nu^2 / (R_i S_i), floor)
//            What served best so far leads, its R and q are those reported, but by no more than
//            e^kLongScoreFloor, and by e^kLivelier more for each member in between if the other is
//            livelier: when the jaw starts or stops, a few samples put another member in charge,
//            and of those that explain these as well the least lively.
// Floor.     max_j log R_j S_j + gate^2, common to all members. A sample that even the widest does
//            not expect does not show which is right. If only the last term were bounded, each
//            such sample would favour the narrowest, and uncertainty would shrink while nothing is
//            measured.
//
// The two memories are this project's. Their constants were chosen on simulated chewing:
// kShortMemory 4 to 12, kLongScoreFloor 8 to 12 and kIndependentShare 0.15 to 1 change the mean
// velocity error by less than 1 %.
#pragma once

#include <algorithm>
#include <limits>

#include "condyle/estimator/math/elementary.h"
#include "condyle/estimator/motion/motion_parameters.h"

namespace condyle {

/// Noise and weights of at most `kMembers` members along one axis.
template <class Scalar, int kMembers>
class MemberWeights {
 public:
  /// One scalar for each member.
  using Each = Array<Scalar, kMembers>;

  static constexpr Scalar kPlausible = Scalar(1e-3);      ///< least weight that counts
  static constexpr Scalar kLikelyWeight = Scalar(0.003);  ///< and least that can excuse a sample

  /// Adaptive members: all start with the noise `R` (m^2), limited to `lowest_R` to `highest_R`.
  /// The one in the middle leads; the least lively has the largest weight.
  void start(int count, Scalar R, Scalar lowest_R, Scalar highest_R) {
    count_ = count;
    lowest_R_ = lowest_R;
    highest_R_ = highest_R;
    leader_ = count / 2;
    Scalar sum = 0;
    for (int i = 0; i < count; ++i) {
      set_R(i, std::clamp(R, floor_R(), highest_R_));
      short_score_[i] = 0;
      weight_[i] = elementary::exp(-kLivelier * static_cast<Scalar>(i));
      sum += weight_[i];
    }
    for (int i = 0; i < count; ++i) weight_[i] /= sum;
  }

  /// Members of known noise, of which only `chosen` counts.
  void start_fixed(int count, int chosen, Scalar R) {
    count_ = count;
    leader_ = chosen;
    level(0);
    weight_[chosen] = 1;
    for (int i = 0; i < count; ++i) set_R(i, R);
  }

  /// Raises the noise to at least that of rounding, `R` (m^2).
  void hold_above(Scalar R) {
    if (R == rounding_R_) return;
    rounding_R_ = R;
    for (int i = 0; i < count_; ++i) {
      if (R_[i] < R) set_R(i, std::min(R, highest_R_));
    }
  }

  /// True if the noise of rounding is known.
  bool is_rounded() const { return rounding_R_ > Scalar(0); }

  /// Raises the noise to at least that of `other`.
  void take_larger_noise(const MemberWeights& other) {
    for (int i = 0; i < count_; ++i) {
      if (R_[i] < other.R_[i]) set_R(i, other.R_[i]);
    }
  }

  /// True if a squared innovation `share`, in units of R, is within `limit` for any member.
  bool is_expected(const Each& share, Scalar limit) const {
    for (int i = 0; i < count_; ++i) {
      if (share[i] <= limit * R_[i]) return true;
    }
    return false;
  }

  /// Learns only the noise from a sample that no member expects: it grows by the same factor for
  /// all, so that the weights stay.
  void learn_noise_of_unexpected(Scalar growth) {
    for (int i = 0; i < count_; ++i) set_R(i, std::min(R_[i] * growth, highest_R_));
  }

  /// Learns from one sample: `share` is nu^2 / S. `learns_noise` is false after a restart, when S
  /// is far above 1 and nu contains no information on the noise.
  void learn(const Each& share, const Each& log_S, Scalar gain, bool learns_noise,
             Scalar largest_share, Scalar largest_deviation) {
    Scalar floor = log_R_[0] + log_S[0];
    for (int i = 1; i < count_; ++i) floor = std::max(floor, log_R_[i] + log_S[i]);
    floor += largest_deviation;
    const Scalar lowest_R = floor_R();
    for (int i = 0; i < count_; ++i) {
      const Scalar R = R_[i];
      const Scalar surprise = std::min(log_R_[i] + log_S[i] + share[i] / R, floor);
      short_score_[i] -= short_score_[i] * (Scalar(1) / kShortMemory) + Scalar(0.5) * surprise;
      if (!learns_noise) continue;
      const Scalar next = R + gain * (std::min(share[i], largest_share * R) - R);
      set_R(i, std::clamp(next, lowest_R, highest_R_));
    }
  }

  /// Weighs the members after `learn`, by their likelihoods over `n` samples whose <log S_i> is
  /// `mean_log_S`.
  void weigh(const Each& mean_log_S, Scalar n) {
    Each score;
    const Scalar lowest = score_memory(mean_log_S, n, score) - kLongScoreFloor;
    Scalar best = -std::numeric_limits<Scalar>::infinity();
    for (int i = 0; i < count_; ++i) {
      const Scalar rarity = kLivelier * static_cast<Scalar>(std::max(i - leader_, 0));
      score[i] = std::max(score[i], lowest - rarity) + short_score_[i];
      best = std::max(best, score[i]);
    }
    Scalar sum = 0;
    for (int i = 0; i < count_; ++i) {
      const Scalar behind = score[i] - best;
      weight_[i] = behind < kNegligibleLogWeight ? Scalar(0) : elementary::exp(behind);
      sum += weight_[i];
    }
    const Scalar inverse_sum = Scalar(1) / sum;
    for (int i = 0; i < count_; ++i) weight_[i] *= inverse_sum;
  }

  /// Gives all members the same weight, whatever served best so far; those livelier than the leader
  /// less.
  void forget_weights(const Each& mean_log_S, Scalar n, Scalar share) {
    Each score;
    const Scalar best = score_memory(mean_log_S, n, score);
    // Compensates the lead of the members that served best.
    for (int i = 0; i < count_; ++i) {
      const Scalar level = -std::max(score[i] - best, -kLongScoreFloor);
      short_score_[i] += share * (level - short_score_[i]);
    }
    weigh(mean_log_S, n);
  }

  Scalar weight(int i) const { return weight_[i]; }
  /// Variance of the noise that member `i` estimates (m^2).
  Scalar R(int i) const { return R_[i]; }
  /// The same, but at least that of the leader: a member of larger r explains noise as motion, and
  /// when a start or a stop makes it prevail, the instrument is no better than before.
  Scalar stated_R(int i) const { return std::max(R_[i], R_[leader_]); }
  /// The member that served best over the memory.
  int leader() const { return leader_; }
  /// True if the leader's noise is at its floor or ceiling.
  bool noise_is_at_limit() const {
    const Scalar R = R_[leader_];
    return R <= lowest_R_ * Scalar(1.001) || R >= highest_R_ * Scalar(0.999);
  }

 private:
  static constexpr Scalar kIndependentShare = Scalar(0.3);
  static constexpr Scalar kLongScoreFloor = 6;
  static constexpr Scalar kShortMemory = 8;  // samples
  static constexpr Scalar kLivelier = Scalar(0.5);
  static constexpr Scalar kNegligibleLogWeight = -20;  // log weight behind the best

  // Log likelihoods over the memory, and which of them leads; the leader's.
  Scalar score_memory(const Each& mean_log_S, Scalar n, Each& score) {
    const Scalar factor = Scalar(-0.5) * kIndependentShare * n;
    leader_ = 0;
    for (int i = 0; i < count_; ++i) {
      score[i] = factor * (log_R_[i] + mean_log_S[i]);
      if (score[i] > score[leader_]) leader_ = i;
    }
    return score[leader_];
  }
  Scalar floor_R() const { return std::min(std::max(lowest_R_, rounding_R_), highest_R_); }
  void set_R(int i, Scalar R) {
    R_[i] = R;
    log_R_[i] = elementary::quick_log(R);
  }
  void level(Scalar weight) {
    for (int i = 0; i < count_; ++i) weight_[i] = weight;
  }

  int count_ = 0, leader_ = 0;
  Scalar lowest_R_ = 0, highest_R_ = 0, rounding_R_ = 0;
  Each R_ = {}, log_R_ = {}, short_score_ = {}, weight_ = {};
};

}  // namespace condyle
