// SPDX-License-Identifier: Apache-2.0
// Position, velocity and acceleration along several axes when both the noise of the instrument and
// the jerk density of the motion are unknown: a bank of white-jerk filters (white_jerk.h).
//
//   z       measured position along one axis (m)
//   R, q    variance of its noise (m^2), density of the jerk (m^2/s^5)
//   r = q/R what a filter's gain depends on, besides the times (1/s^5); each member i has its own
//           (jerk_density_grid.h)
//   x_i     state (p, v, a) of member i along one axis (m, m/s, m/s^2)
//   P_i     its covariance in units of R: the same for all axes, whatever was measured
//   nu, S   innovation z - p (m), its variance in units of R: S = P_pp + 1
//   n       samples that noise and weights rest on (sample_memory.h)
//
// Noise and weights of the members, axis by axis: member_weights.h. The noise is known once
// kFewestLearned samples more were within huber than beyond it. After a restart, kFresh samples
// teach no noise: S is then far above 1, and nu^2 / S, however small, contains no information on R.
// Nor does a coordinate that comes for the ninth time in a row or later while its step is unknown
// (rounding_step.h): it shows a step larger than the noise, but not how large. A sample that no
// member expects leaves the weights unchanged. The noise may have grown: R grows, and older samples
// count less.
//
// Estimate.  Mean of the mixture: sum w_i x_i; variance sum w_i (R'_i P_i + (x_i - mean)^2), times
//            n/(n-2) because R was estimated from n samples (Student's t); R'_i is the stated R of
//            member_weights.h. What R' - R adds to the variance of velocity and acceleration is at
//            most kMostAdded times that which the motion started with: noise does not make a
//            velocity less certain than the start left it.
//
// D. T. Magill, Optimal adaptive estimation of sampled stochastic processes, IEEE Trans. Autom.
// Control 10 (1965) 434-439 (the bank).
#pragma once

#include <algorithm>

#include "condyle/estimator/math/elementary.h"
#include "condyle/estimator/motion/fixed_lag.h"
#include "condyle/estimator/motion/jerk_density_grid.h"
#include "condyle/estimator/motion/member_weights.h"
#include "condyle/estimator/motion/motion_parameters.h"
#include "condyle/estimator/motion/sample_memory.h"
#include "condyle/estimator/motion/white_jerk.h"

namespace condyle {

/// The bank. `kAxes`: 1 or 3.
template <class Scalar, int kAxes>
class FilterBank {
 public:
  /// Most members.
  static constexpr int kMostMembers = 18;
  using Position = Array<Scalar, kAxes>;
  using Step = FilteredStep<Scalar, kAxes>;
  using Weights = MemberWeights<Scalar, kMostMembers>;

  /// `parameters` must be valid. Without adaptation there is one member per axis, with its R and q.
  explicit FilterBank(const MotionEstimatorParameters& parameters)
      : adaptive_(parameters.noise.adaptation == Adaptation::on),
        jerk_density_m2_s5_(static_cast<Scalar>(parameters.noise.jerk_density_m2_s5)),
        lowest_R_(square(parameters.noise.lowest_position_sd_m)),
        highest_R_(square(parameters.noise.highest_position_sd_m)),
        prior_velocity_variance_(square(parameters.prior.velocity_sd_m_s)),
        prior_acceleration_variance_(square(parameters.prior.acceleration_sd_m_s2)),
        largest_share_(square(parameters.outliers.huber_sd)),
        largest_deviation_(square(parameters.outliers.gate_sd)),
        member_count_(adaptive_ ? kMostMembers : kAxes),
        memory_(static_cast<Scalar>(parameters.noise.memory_s)) {}

  /// Starts noise and weights: `noise_sd_m` is the instrument's noise, or a first guess of it.
  void start_noise(const Position& noise_sd_m) {
    memory_.start();
    learned_ = 0;
    grid_ = {};
    for (int axis = 0; axis < kAxes; ++axis) {
      const Scalar R = noise_sd_m[axis] * noise_sd_m[axis];
      if (adaptive_) {
        weights_[axis].start(member_count_, R, lowest_R_, highest_R_);
      } else {
        weights_[axis].start_fixed(member_count_, axis, R);
        members_[axis].r = jerk_density_m2_s5_ / R;
      }
    }
    for (Scalar& mean : mean_log_S_) mean = 0;
    if (adaptive_) take_ratios();
  }

  /// Starts the motion at the measured `position_m`; velocity and acceleration from the prior, with
  /// their variances times `scale`.
  void start_motion(const Position& position_m, Scalar scale) {
    Array<Vector3<Scalar>, kAxes> x;
    for (int axis = 0; axis < kAxes; ++axis) x[axis] = {position_m[axis], 0, 0};
    start_motion(x, scale);
    if (scale > Scalar(1)) forget_weights(Scalar(1) - Scalar(1) / scale);
  }

  /// The motion has changed: it continues from the measured `position_m`, with its velocity plus
  /// `velocity_change_m_s` and its acceleration, but with the prior's variances times `scale`. All
  /// members have the same weight; the knowledge of the noise stays.
  void change_motion(const Position& position_m, const Position& velocity_change_m_s,
                     Scalar scale) {
    Array<Vector3<Scalar>, kAxes> x;
    for (int axis = 0; axis < kAxes; ++axis) {
      x[axis] = moments(axis).mean;
      x[axis][kPosition] = position_m[axis];
      x[axis][kVelocity] += velocity_change_m_s[axis];
    }
    start_motion(x, scale);
    forget_weights(1);
  }

  /// The motion turned out to have changed: the leader loses its lead.
  void begin_motion() { same_motion_ = 0; }

  /// Moves all members by a step of `F` and Q / q (white_jerk.h).
  void predict(const TransitionJacobian<Scalar>& F, const SymmetricMatrix3<Scalar>& Q) {
    for (int i = 0; i < member_count_; ++i) {
      Step& step = members_[i].step;
      for (Vector3<Scalar>& x : step.x) x = white_jerk_transition(x, F);
      step.P = propagate_covariance(step.P, F);
      step.P.add_scaled(Q, members_[i].r);
      step.K.setZero();
      step.inverse_S = 0;
      for (Scalar& innovation_m : step.innovation_m) innovation_m = 0;
    }
  }

  /// Learns noise and weights from the measurement `z_m`, `T` s after the last; call it after
  /// `predict`.
  void learn(const Position& z_m, Scalar T) {
    if (!adaptive_) return;
    const Scalar gain = memory_.grow(T);
    if (grid_.follow(memory_.mean_step_s())) take_ratios();
    typename Weights::Each log_S, inverse_S;
    for (int i = 0; i < member_count_; ++i) {
      const Scalar S = innovation_variance(i);
      inverse_S[i] = Scalar(1) / S;
      log_S[i] = elementary::quick_log(S);
    }
    Array<typename Weights::Each, kAxes> share;
    bool is_expected = true;
    for (int axis = 0; axis < kAxes; ++axis) {
      for (int i = 0; i < member_count_; ++i) {
        const Scalar innovation_m = z_m[axis] - members_[i].step.x[axis][kPosition];
        share[axis][i] = innovation_m * innovation_m * inverse_S[i];
      }
      if (weights_[axis].is_expected(share[axis], largest_deviation_)) continue;
      is_expected = false;
      weights_[axis].learn_noise_of_unexpected(growth_of_noise(gain));
    }
    if (!is_expected) {
      memory_.shorten();
      return;
    }
    same_motion_ += Scalar(1);
    const bool learns_noise = fresh_ == 0;
    if (!learns_noise) --fresh_;
    for (int i = 0; learns_noise && i < member_count_; ++i) {
      mean_log_S_[i] += gain * (log_S[i] - mean_log_S_[i]);
    }
    Array<bool, kAxes> shows_step;
    bool shows_noise = true;
    for (int axis = 0; axis < kAxes; ++axis) {
      repeats_[axis] = z_m[axis] == last_m_[axis] ? std::min(repeats_[axis] + 1, kRun) : 0;
      shows_step[axis] = repeats_[axis] >= kRun && !weights_[axis].is_rounded();
      last_m_[axis] = z_m[axis];
      shows_noise = shows_noise && !shows_step[axis];
    }
    if (!noise_is_known() && shows_noise) judge_guess(share);
    for (int axis = 0; axis < kAxes; ++axis) {
      weights_[axis].learn(share[axis], log_S, gain, learns_noise && !shows_step[axis],
                           largest_share_, largest_deviation_);
      weights_[axis].weigh(mean_log_S_, same_motion());
    }
  }

  /// Learns from a probable outlier: the noise may have grown, so R grows and older samples count
  /// less. The weights stay.
  void learn_of_unexpected(Scalar T) {
    if (!adaptive_) return;
    const Scalar gain = memory_.grow(T);
    for (auto& weights : weights_) weights.learn_noise_of_unexpected(growth_of_noise(gain));
    memory_.shorten();
  }

  /// Raises the noise along `axis` to at least `R` (m^2), that of rounding. Known noise stays as it
  /// is.
  void hold_noise_above(int axis, Scalar R) {
    if (adaptive_) weights_[axis].hold_above(R);
  }
  /// Raises the noise to at least that of `other`.
  void take_larger_noise(const FilterBank& other) {
    if (!adaptive_) return;
    for (int axis = 0; axis < kAxes; ++axis) {
      weights_[axis].take_larger_noise(other.weights_[axis]);
    }
  }

  /// Uses the measurement `z_m` with `weight` (1: full), after `predict`. False if an innovation
  /// variance was not positive and finite; that member is left as predicted.
  [[nodiscard]] bool update(const Position& z_m, Scalar weight) {
    bool good = true;
    const Scalar R = Scalar(1) / weight;
    for (int i = 0; i < member_count_; ++i) {
      Step& step = members_[i].step;
      const ScalarGain<Scalar> gain = update_covariance<kPosition>(step.P, R);
      good = good && !gain.refused;
      step.K = gain.K;
      step.inverse_S = gain.inverse_S;
      for (int axis = 0; axis < kAxes; ++axis) {
        step.innovation_m[axis] = z_m[axis] - step.x[axis][kPosition];
        step.x[axis] += gain.K * step.innovation_m[axis];
      }
    }
    return good;
  }

  /// Mixture of the members along `axis`; `moments_of(i)` gives member i's, with variances in units
  /// of R, and is called for plausible members only.
  template <class MomentsOf>
  MotionMoments<Scalar> mixture(int axis, const MomentsOf& moments_of) const {
    MotionMoments<Scalar> mixed;
    Vector3<Scalar> square_sum = Vector3<Scalar>::Zero();
    Vector3<Scalar> reference = Vector3<Scalar>::Zero();
    Scalar weight_sum = 0;
    for (int i = 0; i < member_count_; ++i) {
      const Scalar weight = weights_[axis].weight(i);
      if (!(weight > Weights::kPlausible)) continue;
      const MotionMoments<Scalar> moments = moments_of(i);
      if (weight_sum == Scalar(0)) reference = moments.mean;
      // Deviations from one member's mean: sums of squares of the means themselves would cancel.
      const Vector3<Scalar> deviation = moments.mean - reference;
      weight_sum += weight;
      mixed.mean += weight * deviation;
      mixed.variance += weight * stated_variance(axis, i, moments.variance);
      square_sum += weight * deviation.cwiseProduct(deviation);
    }
    const Scalar scale = Scalar(1) / weight_sum;
    mixed.mean *= scale;
    const Vector3<Scalar> spread = scale * square_sum - mixed.mean.cwiseProduct(mixed.mean);
    mixed.variance = (scale * mixed.variance + spread.cwiseMax(Scalar(0))) * uncertainty_of_noise();
    mixed.mean += reference;
    return mixed;
  }

  /// The bank's estimate along `axis` after the last `predict` or `update`.
  MotionMoments<Scalar> moments(int axis) const {
    return mixture(axis, [&](int i) { return filtered_moments(i, axis); });
  }

  /// True if member `i` counts along any axis.
  bool is_plausible(int i) const {
    for (const Weights& weights : weights_) {
      if (weights.weight(i) > Weights::kPlausible) return true;
    }
    return false;
  }

  /// Variance of the noise along `axis` (m^2), as given or as estimated by the leader.
  Scalar noise_variance_m2(int axis) const { return weights_[axis].R(leader(axis)); }
  /// Density of the jerk along `axis` (m^2/s^5), as given or as estimated by the leader.
  Scalar jerk_density_m2_s5(int axis) const {
    return members_[leader(axis)].r * noise_variance_m2(axis);
  }
  /// Velocity along `axis` by the leader (m/s).
  Scalar leading_velocity_m_s(int axis) const { return step(leader(axis)).x[axis][kVelocity]; }
  /// True if noise and jerk density are estimated, not given.
  bool is_adaptive() const { return adaptive_; }
  /// False while the noise rests more on the first guess than on samples: the intervals then rest
  /// on that guess.
  bool noise_is_known() const { return !adaptive_ || learned_ >= kFewestLearned; }
  /// True if the estimated noise along `axis` is at its floor or ceiling.
  bool noise_is_at_limit(int axis) const { return adaptive_ && weights_[axis].noise_is_at_limit(); }
  /// True if the jerk density along `axis` is at the highest value that the bank can tell from
  /// noise.
  bool jerk_density_is_at_limit(int axis) const {
    return adaptive_ && leader(axis) == member_count_ - 1;
  }

  /// Number of members.
  int member_count() const { return member_count_; }
  /// Ratio r of member `i` (1/s^5).
  Scalar ratio(int i) const { return members_[i].r; }
  /// Noise that member `i` estimates along `axis` (m^2).
  Scalar R(int axis, int i) const { return weights_[axis].R(i); }
  /// R' of member `i` along `axis` (m^2).
  Scalar stated_R(int axis, int i) const {
    return adaptive_ ? weights_[axis].stated_R(i) : weights_[axis].R(i);
  }
  /// S of member `i`, after `predict`.
  Scalar innovation_variance(int i) const {
    return members_[i].step.P(kPosition, kPosition) + Scalar(1);
  }
  /// Weight of member `i` along `axis`.
  Scalar weight(int axis, int i) const { return weights_[axis].weight(i); }
  /// Member `i` after the last sample.
  const Step& step(int i) const { return members_[i].step; }

 private:
  static constexpr int kFewestLearned = 15;  // then the first guess is forgotten
  static constexpr int kFresh = 3;
  static constexpr int kRun = 8;
  static constexpr Scalar kMostAdded = 4;
  // Of the next position, in units of R; with larger values an update would leave rounding errors.
  static constexpr Scalar kMostStartVariance =
      Scalar(1) / (Scalar(64) * std::numeric_limits<Scalar>::epsilon());

  struct Member {
    Scalar r{};
    Step step;
  };

  static Scalar square(double value) { return static_cast<Scalar>(value * value); }

  void start_motion(const Array<Vector3<Scalar>, kAxes>& x, Scalar scale) {
    fresh_ = kFresh;
    start_scale_ = scale;
    const Scalar square_step_s2 = memory_.mean_step_s() * memory_.mean_step_s();
    const Scalar most_velocity = kMostStartVariance / square_step_s2;
    const Scalar most_acceleration = most_velocity / square_step_s2;
    for (int i = 0; i < member_count_; ++i) {
      // One covariance for all axes: the least noise makes the prior widest.
      Scalar R = weights_[adaptive_ ? 0 : i].R(i);
      for (int axis = 1; adaptive_ && axis < kAxes; ++axis) R = std::min(R, weights_[axis].R(i));
      Step& step = members_[i].step;
      step = Step();
      step.P = SymmetricMatrix3<Scalar>::diagonal(
          {1, std::min(scale * prior_velocity_variance_ / R, most_velocity),
           std::min(scale * prior_acceleration_variance_ / R, most_acceleration)});
      for (int axis = 0; axis < kAxes; ++axis) step.x[axis] = x[axis];
    }
  }

  void forget_weights(Scalar share) {
    if (!adaptive_) return;
    for (auto& weights : weights_) weights.forget_weights(mean_log_S_, same_motion(), share);
  }

  void take_ratios() {
    for (int i = 0; i < member_count_; ++i) members_[i].r = grid_[i];
  }

  Scalar growth_of_noise(Scalar gain) const {
    return Scalar(1) + gain * (largest_share_ - Scalar(1));
  }

  // A noise that samples keep exceeding is still growing from the guess.
  void judge_guess(const Array<typename Weights::Each, kAxes>& share) {
    bool is_within = true;
    for (int axis = 0; axis < kAxes; ++axis) {
      const int i = leader(axis);
      is_within = is_within && share[axis][i] <= largest_share_ * weights_[axis].R(i);
    }
    learned_ = is_within ? learned_ + 1 : std::max(learned_ - 1, 0);
  }

  MotionMoments<Scalar> filtered_moments(int i, int axis) const {
    const Step& step = members_[i].step;
    return {step.x[axis], {step.P(0, 0), step.P(1, 1), step.P(2, 2)}};
  }

  Scalar uncertainty_of_noise() const {
    return adaptive_ ? memory_.n() / (memory_.n() - Scalar(2)) : Scalar(1);
  }

  // `variance`, in units of R, of member `i`'s position, velocity and acceleration.
  Vector3<Scalar> stated_variance(int axis, int i, const Vector3<Scalar>& variance) const {
    const Scalar R = weights_[axis].R(i), added_R = stated_R(axis, i) - R;
    const Vector3<Scalar> most(std::numeric_limits<Scalar>::infinity(),
                               kMostAdded * start_scale_ * prior_velocity_variance_,
                               kMostAdded * start_scale_ * prior_acceleration_variance_);
    return R * variance + (added_R * variance).cwiseMin(most);
  }
  // Samples that show which member suits the present motion.
  Scalar same_motion() const { return std::min(memory_.n(), same_motion_); }
  int leader(int axis) const { return weights_[axis].leader(); }

  bool adaptive_;
  Scalar jerk_density_m2_s5_, lowest_R_, highest_R_;
  Scalar prior_velocity_variance_, prior_acceleration_variance_;
  Scalar largest_share_, largest_deviation_;
  int member_count_;
  SampleMemory<Scalar> memory_;
  int learned_ = 0;  // samples within huber, less those beyond
  Scalar start_scale_ = 1;
  Scalar same_motion_ = std::numeric_limits<Scalar>::infinity();  // samples since it changed
  int fresh_ = 0;                   // samples that will not teach the noise yet
  Position last_m_ = {};            // position learned from last,
  Array<int, kAxes> repeats_ = {};  // and how often in a row it came before
  JerkDensityGrid<Scalar, kMostMembers> grid_;
  typename Weights::Each mean_log_S_ = {};
  Array<Weights, kAxes> weights_;
  Array<Member, kMostMembers> members_;
};

}  // namespace condyle
