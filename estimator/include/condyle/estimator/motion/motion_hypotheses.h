// SPDX-License-Identifier: Apache-2.0
// Explains unexpected samples by two hypotheses, each a bank of filters, until later samples decide
// between them.
//
//   main    the motion goes on as it was, and a sample beyond the gate is an outlier
//   other   the motion changed: it goes on from that sample, with the velocity that reaches it, but
//           velocity and acceleration hardly known
//   s       share of other (change_odds.h)
//   d       innovation of the sample that other starts from (m)
//   T       time since main last took a sample, no less than the mean step (s)
//   V       variance of velocity that a jaw's prior and this motion's speeds allow (m^2/s^2)
//
// Start.   A motion whose velocity changed within T, at an instant of which nothing is known,
//          changed it by 3/2 d/T; an outlier does not show it, and the farther d is from what V
//          allows, the likelier it is one. Other starts with main's velocity plus
//          3/2 d/T V / (V + (d/T)^2), and the variance V + (d/T)^2: a motion that went so far may
//          go on as fast. The event is `motion_changed` if the sample may well be a change, else
//          `outlier_rejected`.
// Tests.   A sample fits a hypothesis if it is within the gate and, by the noise that the
//          members have made out themselves, likelier than as one more outlier. From one that fits
//          neither, other starts anew, and after `reset_after` in a row main is given up.
// Shown.   The mixture of both, its first two moments matched.
//
// A sample within the gate but beyond huber counts less. Main has taken it; the second bank goes on
// without it until the next sample. Then main is misled if both samples are likelier by e^3 with
// the first as the outlier, by the noise that the members have made out themselves:
//          log u' + log p_second(z) > log p_main(first) + max(log p_main(z), log u') + 3
// u' being the density of outliers times their rarity, e^kLogRarity. Then the second bank takes
// main's place. A bank of fewer than kSettled samples is too wide to judge.
#pragma once

#include "condyle/estimator/events.h"
#include "condyle/estimator/motion/change_odds.h"
#include "condyle/estimator/motion/motion_expectation.h"
#include "condyle/estimator/motion/outlier_gate.h"
#include "condyle/estimator/motion/unseen_change.h"

namespace condyle {

/// What became of one sample.
template <class Scalar, int kAxes>
struct SampleVerdict {
  Array<Scalar, kAxes> innovation_m = {};
  Array<Scalar, kAxes> variance_m2 = {};  ///< of the innovation
  bool is_taken[2] = {};                  ///< by the first and the second bank
  bool is_start[2] = {};                  ///< it restarts from this sample
  bool is_known = false;                  ///< a hypothesis expected it
  int settled = -1;  ///< the bank that was right about the previous samples; -1: open
  EventSet events;
};

/// Two hypotheses about one motion. Banks are named by their index, 0 or 1.
template <class Scalar, int kAxes>
class MotionHypotheses {
 public:
  using Bank = FilterBank<Scalar, kAxes>;
  using Position = typename Bank::Position;
  using Verdict = SampleVerdict<Scalar, kAxes>;
  using Odds = ChangeOdds<Scalar, kAxes>;

  /// `parameters` must be valid.
  explicit MotionHypotheses(const MotionEstimatorParameters& parameters)
      : prior_velocity_variance_(static_cast<Scalar>(parameters.prior.velocity_sd_m_s *
                                                     parameters.prior.velocity_sd_m_s)),
        prior_acceleration_variance_(static_cast<Scalar>(parameters.prior.acceleration_sd_m_s2 *
                                                         parameters.prior.acceleration_sd_m_s2)),
        most_refusals_(static_cast<Scalar>(parameters.outliers.reset_after)),
        gate_(parameters.outliers),
        banks_{Bank(parameters), Bank(parameters)} {}

  /// Starts noise and weights (m).
  void start_noise(const Position& noise_sd_m) { main_bank().start_noise(noise_sd_m); }

  /// The motion starts at `position_m`, measured.
  void start_motion(const Position& position_m) {
    main_bank().start_motion(position_m,
                             std::max(Scalar(1), mean_square_speed_ / prior_velocity_variance_));
    doubt_ = Doubt::none;
    settled_ = 0;
    note_taken();
  }

  /// The motion is lost, and with it any open question.
  void lose_motion() { doubt_ = Doubt::none; }

  /// Moves all banks by a step of `F` and Q / q, `T` s long.
  void predict(Scalar T, const TransitionJacobian<Scalar>& F, const SymmetricMatrix3<Scalar>& Q) {
    untaken_s_ += T;
    main_bank().predict(F, Q);
    if (doubt_ != Doubt::none) other_bank().predict(F, Q);
  }

  /// Raises the noise along `axis` to at least `R` (m^2), that of rounding.
  void hold_noise_above(int axis, Scalar R) {
    main_bank().hold_noise_above(axis, R);
    if (doubt_ != Doubt::none) other_bank().hold_noise_above(axis, R);
  }

  /// Uses the measurement `z_m`, `T` s after the last sample; call it after `predict`.
  Verdict take(const Position& z_m, Scalar T) {
    Verdict verdict;
    if (T > Scalar(0)) {
      mean_step_s_ += mean_step_s_ > Scalar(0) ? kStepGain * (T - mean_step_s_) : T;
    }
    if (doubt_ == Doubt::motion) {
      take_in_doubt(z_m, T, verdict);
    } else {
      take_alone(z_m, T, verdict);
    }
    ++untaken_;
    if (verdict.is_taken[main_]) note_taken();
    return verdict;
  }

  /// Share of the second hypothesis, 0 to 1.
  Scalar share_of_other() const {
    return doubt_ == Doubt::motion ? odds_.share_of_change() : Scalar(0);
  }
  /// True if there are two banks.
  bool has_other() const { return doubt_ != Doubt::none; }
  int main_index() const { return main_; }
  const Bank& main() const { return banks_[main_]; }
  const Bank& other() const { return banks_[1 - main_]; }

  /// Moments of the mixture of both, from `of_main` and `of_other`.
  MotionMoments<Scalar> mixture(MotionMoments<Scalar> of_main,
                                const MotionMoments<Scalar>& of_other) const {
    const Scalar share = share_of_other();
    const Vector3<Scalar> gap = of_other.mean - of_main.mean;
    of_main.mean += share * gap;
    of_main.variance = (Scalar(1) - share) * of_main.variance + share * of_other.variance +
                       share * (Scalar(1) - share) * gap.cwiseProduct(gap);
    return of_main;
  }

  /// Motion along `axis`, both hypotheses.
  MotionMoments<Scalar> moments(int axis) const {
    if (doubt_ != Doubt::motion) return main().moments(axis);
    return mixture(main().moments(axis), other().moments(axis));
  }

  /// True if the previous motion does not predict the measurement `z_m`, after `predict`.
  bool is_unexpected(const Position& z_m) const { return compare(main(), z_m).is_outlier; }

  /// What a change of the motion adds to the variances in a gap of `t` s (unseen_change.h).
  Vector3<Scalar> gap_variance(Scalar t) const { return unseen_change().in_gap(t); }
  /// What it adds to that of velocity through a sample of this innovation (m) and variance (m^2),
  /// `T` s after the last.
  Scalar onset_variance(Scalar innovation_m, Scalar variance_m2, Scalar T) const {
    return unseen_change().at_onset(innovation_m, variance_m2, std::max(T, mean_step_s_));
  }

 private:
  enum class Doubt { none, sample, motion };

  static constexpr Scalar kLikelier = 3;
  static constexpr Scalar kLogRarity = Scalar(-4.6);  // log 1/100: of outliers
  static constexpr int kSettled = 5;
  static constexpr Scalar kSpeedGain = Scalar(0.01);
  static constexpr Scalar kStepGain = Scalar(0.05);
  static constexpr Scalar kWidest = Scalar(1e4);

  // A bank's view of a sample.
  struct Comparison {
    Position innovation_m = {}, variance_m2 = {};
    Scalar of_likely = 0;   // squared deviation from the likely member that it fits best,
    Scalar of_mixture = 0;  // from the mixture; the largest of all axes
    bool is_outlier = false;
  };

  Bank& main_bank() { return banks_[main_]; }
  Bank& other_bank() { return banks_[1 - main_]; }

  Comparison compare(const Bank& bank, const Position& z_m) const {
    Comparison result;
    // Written so that NaN is the largest.
    const auto enlarge = [](Scalar& largest, Scalar value) {
      if (!(value <= largest)) largest = value;
    };
    for (int axis = 0; axis < kAxes; ++axis) {
      const auto expected = expectation(bank, axis, z_m[axis]);
      result.innovation_m[axis] = z_m[axis] - expected.position_m;
      result.variance_m2[axis] = expected.variance_m2;
      enlarge(result.of_likely, expected.of_likely_squared);
      enlarge(result.of_mixture, expected.of_mixture_squared);
    }
    result.is_outlier = gate_.is_outlier(result.of_likely);
    return result;
  }

  static void note(const Comparison& comparison, Verdict& verdict) {
    for (int axis = 0; axis < kAxes; ++axis) {
      verdict.innovation_m[axis] = comparison.innovation_m[axis];
      verdict.variance_m2[axis] = comparison.variance_m2[axis];
    }
  }

  void take_alone(const Position& z_m, Scalar T, Verdict& verdict) {
    Comparison comparison = compare(main(), z_m);
    if (doubt_ == Doubt::sample && is_misled(z_m)) {
      main_ = 1 - main_;
      comparison = compare(main(), z_m);
      verdict.events.add(Event::outlier_revoked);
    }
    if (doubt_ == Doubt::sample) settle(main_, verdict);
    note(comparison, verdict);
    if (comparison.is_outlier) {
      refusals_ = 1;
      doubt_motion(z_m, comparison, verdict);
      return;
    }
    if (gate_.is_doubtful(comparison.of_mixture) && settled_ >= kSettled) {
      other_bank() = main();
      suspect_log_density_ = log_density<Noise::own>(main(), z_m);
      doubt_ = Doubt::sample;
    }
    update(main_, z_m, T, comparison, verdict);
    verdict.is_known = true;
    settled_ = std::min(settled_ + 1, kSettled);
    learn_speed();
  }

  // Main has used a doubtful sample before `z_m`; both are far likelier if that one was an outlier.
  bool is_misled(const Position& z_m) const {
    const Scalar outlier = kLogRarity + kAxes * elementary::quick_log(Odds::kOutlierDensity);
    const Scalar with =
        suspect_log_density_ + std::max(log_density<Noise::own>(main(), z_m), outlier);
    return outlier + log_density<Noise::own>(other(), z_m) > with + kLikelier;
  }

  void take_in_doubt(const Position& z_m, Scalar T, Verdict& verdict) {
    const Comparison by_main = compare(main(), z_m), by_other = compare(other(), z_m);
    note_mixture(by_main, by_other, verdict);
    const bool fits_main = fits(main(), by_main, z_m), fits_other = fits(other(), by_other, z_m);
    if (!fits_main && !fits_other) {
      refuse(z_m, T, by_main, verdict);
      return;
    }
    refusals_ = 0;
    const bool may_be_change = odds_.is_conceivable();
    const auto decision =
        odds_.test(log_likelihood(other(), by_other, z_m, Odds::kBurstInChange),
                   log_likelihood(main(), by_main, z_m, Odds::kBurstInMotion), fits_main);
    if (fits_main) {
      update(main_, z_m, T, by_main, verdict);
    } else {
      learn_of_refused(z_m, T, may_be_change);
    }
    if (fits_other) update(1 - main_, z_m, T, by_other, verdict);
    verdict.is_known = true;
    if (decision == Odds::Decision::outlier) settle(main_, verdict);
    if (decision == Odds::Decision::change) {
      other_bank().take_larger_noise(main());
      other_bank().begin_motion();
      settle(1 - main_, verdict);
    }
    verdict.events.add(Event::motion_changed, !fits_main);
  }

  // Main did not expect `z_m`. If the motion may have changed, a livelier member may have; from
  // outliers main learns only that they are there.
  void learn_of_refused(const Position& z_m, Scalar T, bool may_be_change) {
    if (may_be_change) {
      main_bank().learn(z_m, T);
    } else {
      main_bank().learn_of_unexpected(T);
    }
  }

  // Neither hypothesis expected `z_m`.
  void refuse(const Position& z_m, Scalar T, const Comparison& by_main, Verdict& verdict) {
    verdict.settled = main_;
    learn_of_refused(z_m, T, odds_.is_conceivable());
    ++refusals_;
    doubt_motion(z_m, by_main, verdict);
    if (static_cast<Scalar>(refusals_) < most_refusals_) return;
    main_ = 1 - main_;
    start_motion(z_m);
    verdict.is_known = true;
    verdict.events = {};
    verdict.events.add(Event::state_restarted);
  }

  // The second bank starts from `z_m`, which main did not expect.
  void doubt_motion(const Position& z_m, const Comparison& by_main, Verdict& verdict) {
    const Scalar V = allowed_square_speed();
    const Scalar since_s = std::max(untaken_s_, mean_step_s_);
    const Scalar square_s2 = since_s * since_s;
    Scalar square_speed = 0;
    Position velocity_change_m_s;
    for (int axis = 0; axis < kAxes; ++axis) {
      const Scalar d = by_main.innovation_m[axis];
      square_speed = std::max(square_speed, d * d / square_s2);
      // No step and no innovation: no change.
      const Scalar square_m2 = std::max(V * square_s2 + d * d, std::numeric_limits<Scalar>::min());
      velocity_change_m_s[axis] = Scalar(1.5) * V * d * since_s / square_m2;
    }
    const bool may_be_change =
        odds_.start(by_main.innovation_m, by_main.variance_m2, V * square_s2,
                    {.is_open = doubt_ == Doubt::motion, .unexpected = untaken_ + 1});
    other_bank() = main();
    other_bank().change_motion(z_m, velocity_change_m_s,
                               std::min((V + square_speed) / prior_velocity_variance_, kWidest));
    doubt_ = Doubt::motion;
    verdict.is_start[1 - main_] = verdict.is_taken[1 - main_] = true;
    verdict.events.add(may_be_change ? Event::motion_changed : Event::outlier_rejected);
  }

  UnseenChange<Scalar> unseen_change() const {
    return {prior_acceleration_variance_, allowed_square_speed()};
  }

  // V.
  Scalar allowed_square_speed() const { return prior_velocity_variance_ + 4 * mean_square_speed_; }

  Scalar log_burst(const Comparison& comparison, Scalar share) const {
    return odds_.log_burst(comparison.innovation_m, comparison.variance_m2, share);
  }
  Scalar log_likelihood(const Bank& bank, const Comparison& comparison, const Position& z_m,
                        Scalar share) const {
    return std::max(log_density<Noise::stated>(bank, z_m), log_burst(comparison, share));
  }
  // In doubt: likelier by the members' own noise than as one more outlier.
  bool fits(const Bank& bank, const Comparison& comparison, const Position& z_m) const {
    return !comparison.is_outlier &&
           log_density<Noise::own>(bank, z_m) > log_burst(comparison, Odds::kBurstInMotion);
  }

  // From the bank `index`, which expected it.
  void update(int index, const Position& z_m, Scalar T, const Comparison& comparison,
              Verdict& verdict) {
    const Scalar weight = gate_.weight(comparison.of_likely);
    verdict.events.add(Event::outlier_weighted, weight < Scalar(1));
    banks_[index].learn(z_m, T);
    verdict.events.add(Event::update_refused, !banks_[index].update(z_m, weight));
    verdict.is_taken[index] = true;
  }

  void note_mixture(const Comparison& by_main, const Comparison& by_other, Verdict& verdict) const {
    const Scalar share = share_of_other();
    for (int axis = 0; axis < kAxes; ++axis) {
      const Scalar gap = by_other.innovation_m[axis] - by_main.innovation_m[axis];
      verdict.innovation_m[axis] = by_main.innovation_m[axis] + share * gap;
      verdict.variance_m2[axis] = (1 - share) * by_main.variance_m2[axis] +
                                  share * by_other.variance_m2[axis] +
                                  share * (1 - share) * gap * gap;
    }
  }

  void note_taken() {
    untaken_ = 0;
    untaken_s_ = 0;
  }

  // The bank `index` was right.
  void settle(int index, Verdict& verdict) {
    if (index != main_) settled_ = 0;
    main_ = index;
    doubt_ = Doubt::none;
    verdict.settled = index;
  }

  void learn_speed() {
    Scalar square_speed = 0;
    for (int axis = 0; axis < kAxes; ++axis) {
      const Scalar velocity_m_s = main().leading_velocity_m_s(axis);
      square_speed = std::max(square_speed, velocity_m_s * velocity_m_s);
    }
    square_speed = std::min(square_speed, kWidest * prior_velocity_variance_);
    mean_square_speed_ += kSpeedGain * (square_speed - mean_square_speed_);
  }

  Scalar prior_velocity_variance_, prior_acceleration_variance_, most_refusals_;
  OutlierGate<Scalar> gate_;
  Bank banks_[2];
  int main_ = 0;
  Doubt doubt_ = Doubt::none;
  int refusals_ = 0;                // samples in a row that fitted neither hypothesis
  Scalar suspect_log_density_ = 0;  // log density that main predicted for its doubtful sample
  int settled_ = 0;                 // samples that main has used since its start, at most kSettled
  Odds odds_;                       // of other against main
  int untaken_ = 0;                 // samples since main used one
  Scalar untaken_s_ = 0;            // time since then
  Scalar mean_step_s_ = 0;
  Scalar mean_square_speed_ = 0;
};

}  // namespace condyle
