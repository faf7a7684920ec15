// SPDX-License-Identifier: Apache-2.0
// Position, velocity and acceleration along several axes when neither the noise of the instrument
// nor the liveliness of the motion is known: a bank of white-jerk filters (white_jerk.h).
//
//   z       measured position along one axis (m)
//   R, q    variance of its noise (m^2), density of the jerk (m^2/s^5)
//   r = q/R what a filter's gain depends on, besides the times (1/s^5); each member i has its own
//   x_i     state (p, v, a) of member i along one axis (m, m/s, m/s^2)
//   P_i     its covariance in units of R: the same for all axes, whatever was measured
//   nu, S   innovation z - p (m), its variance in units of R: S = P_pp + 1
//   <>      mean over the last n samples, older ones forgotten exponentially; n grows to `memory_s`
//
// Noise.     For a given r the likelihood is largest at R_i = <nu^2 / S>: a mean of positive
//            numbers, held between floor and ceiling. Then q_i = r_i R_i. Each nu^2 / S counts at
//            most huber^2 R_i, so that glitches do not become noise. n grows by kGrowth a sample,
//            so that the first guess is forgotten as n^-3, not as 1/n. The noise is known once
//            kFewestLearned samples more were within huber than beyond it.
// Weights.   log w_i = max(long_i - max long, -kLead) + short_i, up to a constant:
//            long_i    log likelihood over the memory, -n/2 (log R_i + <log S_i>), tempered: jaw
//                      motion is no white jerk, innovations are correlated, and n of them count as
//                      kIndependentShare n
//            short_i   log likelihood of about the last kShortMemory samples, -1/2 sum(log R_i S +
//                      nu^2 / (R_i S)), nu^2 / (R_i S) at most gate^2
//            What served best so far leads, its R and q are those reported, but by no more than
//            e^kLead: when the jaw starts or stops, a few samples put another member in charge.
// Estimate.  Mean of the mixture: sum w_i x_i; variance sum w_i (R'_i P_i + (x_i - mean)^2), times
//            n/(n-2) because R was estimated from n samples (Student's t). R'_i is R_i, but no less
//            than the R of the member that leads: a member of larger r explains noise as motion,
//            and when a start or a stop puts it in charge, the instrument is no better than it was.
//
// D. T. Magill, Optimal adaptive estimation of sampled stochastic processes, IEEE Trans. Autom.
// Control 10 (1965) 434-439 (the bank); P. R. Kalata, The tracking index, IEEE Trans. Aerosp.
// Electron. Syst. 20 (1984) 174-182 (r T^5). The two memories are this project's. Their constants
// were chosen on simulated chewing: kShortMemory 4 to 12, kLead 8 to 12 and kIndependentShare 0.15
// to 1 change the mean velocity error by less than 1 %.
#pragma once

#include <algorithm>

#include "condyle/estimator/elementary.h"
#include "condyle/estimator/fixed_lag.h"
#include "condyle/estimator/recommended_parameters.h"
#include "condyle/estimator/white_jerk.h"

namespace condyle {

/// What the bank expects of the next measurement along one axis.
template <class Scalar>
struct Expectation {
  Scalar position_m{};   ///< mean of the mixture
  Scalar variance_m2{};  ///< of the innovation, as stated
  // innovation^2 / variance, with the noise that each member has made out itself:
  Scalar of_likely_squared{};   ///< of the likely member it fits best
  Scalar of_mixture_squared{};  ///< of the mixture
};

/// The bank. `kAxes`: 1 or 3.
template <class Scalar, int kAxes>
class MotionBank {
 public:
  /// Most members.
  static constexpr int kMostMembers = 14;
  using Position = Array<Scalar, kAxes>;
  using Step = FilteredStep<Scalar, kAxes>;

  /// `parameters` must be valid. With adaptation off there is a member per axis, for its R and q.
  explicit MotionBank(const RecommendedParameters& parameters)
      : adaptive_(parameters.noise.adaptation == Adaptation::on),
        memory_s_(static_cast<Scalar>(parameters.noise.memory_s)),
        jerk_density_m2_s5_(static_cast<Scalar>(parameters.noise.jerk_density_m2_s5)),
        lowest_R_(square(parameters.noise.lowest_position_sd_m)),
        highest_R_(square(parameters.noise.highest_position_sd_m)),
        prior_velocity_variance_(square(parameters.prior.velocity_sd_m_s)),
        prior_acceleration_variance_(square(parameters.prior.acceleration_sd_m_s2)),
        largest_share_(square(parameters.outliers.huber_sd)),
        largest_deviation_(square(parameters.outliers.gate_sd)),
        member_count_(adaptive_ ? kMostMembers : kAxes) {}

  /// Starts noise and weights: `noise_sd_m` is the instrument's noise, or the first guess of it.
  void start_noise(const Position& noise_sd_m) {
    n_ = kFirstSamples;
    mean_step_s_ = 0;
    learned_ = 0;
    for (int axis = 0; axis < kAxes; ++axis) leader_[axis] = adaptive_ ? kMostMembers / 2 : axis;
    for (int i = 0; i < member_count_; ++i) {
      Member& member = members_[i];
      member.mean_log_S = 0;
      for (Scalar& score : member.short_score) score = 0;
      for (int axis = 0; axis < kAxes; ++axis) {
        const Scalar R = noise_sd_m[axis] * noise_sd_m[axis];
        member.R[axis] = adaptive_ ? std::clamp(R, lowest_R_, highest_R_) : R;
        member.log_R[axis] = elementary::quick_log(member.R[axis]);
        member.weight[axis] = adaptive_   ? Scalar(1) / Scalar(member_count_)
                              : i == axis ? Scalar(1)
                                          : Scalar(0);
      }
      member.r =
          adaptive_ ? static_cast<Scalar>(kRatios[i]) : jerk_density_m2_s5_ / member.R[i % kAxes];
    }
  }

  /// Starts the motion at `position_m`, measured; velocity and acceleration from the prior.
  void start_motion(const Position& position_m) {
    for (int i = 0; i < member_count_; ++i) {
      Member& member = members_[i];
      // One covariance for all axes: the least noise leaves the prior widest.
      const Scalar R = adaptive_ ? *std::min_element(member.R, member.R + kAxes) : member.R[i];
      member.step = Step();
      member.step.P = SymmetricMatrix3<Scalar>::diagonal(
          {1, prior_velocity_variance_ / R, prior_acceleration_variance_ / R});
      for (int axis = 0; axis < kAxes; ++axis) member.step.x[axis] = {position_m[axis], 0, 0};
    }
  }

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

  /// What was expected of the measurement `z_m` along `axis`, after `predict`.
  Expectation<Scalar> expectation(int axis, Scalar z_m) const {
    Expectation<Scalar> expected;
    Scalar weight_sum = 0;
    expected.of_likely_squared = std::numeric_limits<Scalar>::infinity();
    Scalar own_variance_m2 = 0;
    for (int i = 0; i < member_count_; ++i) {
      const Member& member = members_[i];
      const Scalar weight = member.weight[axis];
      if (!(weight > kPlausible)) continue;
      const Scalar innovation_m = z_m - member.step.x[axis][kPosition];
      const Scalar S = member.step.P(kPosition, kPosition) + Scalar(1);
      weight_sum += weight;
      expected.position_m += weight * member.step.x[axis][kPosition];
      expected.variance_m2 += weight * stated_R(member, axis) * S;
      own_variance_m2 += weight * member.R[axis] * S;
      if (weight > kExcuses) {
        expected.of_likely_squared = std::min(expected.of_likely_squared,
                                              innovation_m * innovation_m / (member.R[axis] * S));
      }
    }
    expected.position_m /= weight_sum;
    expected.variance_m2 /= weight_sum;
    const Scalar innovation_m = z_m - expected.position_m;
    expected.of_mixture_squared = innovation_m * innovation_m * weight_sum / own_variance_m2;
    return expected;
  }

  /// Learns noise and weights from the measurement `z_m`, `T` s after the last, after `predict`.
  void learn(const Position& z_m, Scalar T) {
    if (!adaptive_) return;
    const Scalar gain = grow_memory(T);
    Array<Array<Scalar, kAxes>, kMostMembers> long_score;
    for (int i = 0; i < member_count_; ++i) {
      Member& member = members_[i];
      const Scalar S = member.step.P(kPosition, kPosition) + Scalar(1);
      const Scalar inverse_S = Scalar(1) / S;
      const Scalar log_S = elementary::quick_log(S);
      member.mean_log_S += gain * (log_S - member.mean_log_S);
      for (int axis = 0; axis < kAxes; ++axis) {
        Scalar& R = member.R[axis];
        Scalar& log_R = member.log_R[axis];
        Scalar& short_score = member.short_score[axis];
        const Scalar innovation_m = z_m[axis] - member.step.x[axis][kPosition];
        const Scalar share = innovation_m * innovation_m * inverse_S;
        short_score -= short_score * (Scalar(1) / kShortMemory) +
                       Scalar(0.5) * (log_R + log_S + std::min(share / R, largest_deviation_));
        R = std::clamp(R + gain * (std::min(share, largest_share_ * R) - R), lowest_R_, highest_R_);
        log_R = elementary::quick_log(R);
        long_score[i][axis] = Scalar(-0.5) * kIndependentShare * n_ * (log_R + member.mean_log_S);
      }
    }
    for (int axis = 0; axis < kAxes; ++axis) weigh(axis, long_score);
    if (!noise_is_known()) judge_guess(z_m);
  }

  /// Takes the measurement `z_m` with `weight` (1: in full), after `predict`. False where an
  /// innovation variance was not positive and finite; that member is left as predicted.
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

  /// Mixture of the members along `axis`; `moments_of(i)` gives member i's, its variances in units
  /// of R, and is asked for plausible members only.
  template <class MomentsOf>
  MotionMoments<Scalar> mixture(int axis, const MomentsOf& moments_of) const {
    MotionMoments<Scalar> mixed;
    Vector3<Scalar> square_sum = Vector3<Scalar>::Zero();
    Vector3<Scalar> reference = Vector3<Scalar>::Zero();
    Scalar weight_sum = 0;
    for (int i = 0; i < member_count_; ++i) {
      const Scalar weight = members_[i].weight[axis];
      if (!(weight > kPlausible)) continue;
      const MotionMoments<Scalar> moments = moments_of(i);
      if (weight_sum == Scalar(0)) reference = moments.mean;
      // Deviations from one member's mean: sums of squares of the means themselves would cancel.
      const Vector3<Scalar> deviation = moments.mean - reference;
      weight_sum += weight;
      mixed.mean += weight * deviation;
      mixed.variance += weight * stated_R(members_[i], axis) * moments.variance;
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

  /// True where member `i` has a say along any axis.
  bool is_plausible(int i) const {
    for (const Scalar weight : members_[i].weight) {
      if (weight > kPlausible) return true;
    }
    return false;
  }

  /// Variance of the noise along `axis` (m^2), as given or as the member that leads estimates it.
  Scalar noise_variance_m2(int axis) const { return leader(axis).R[axis]; }
  /// Density of the jerk along `axis` (m^2/s^5), as given or estimated likewise.
  Scalar jerk_density_m2_s5(int axis) const { return leader(axis).r * leader(axis).R[axis]; }
  /// False while the noise is still the first guess more than what the samples say: intervals then
  /// rest on the guess.
  bool noise_is_known() const { return !adaptive_ || learned_ >= kFewestLearned; }
  /// True where the estimated noise along `axis` is held at its floor or ceiling.
  bool noise_is_at_limit(int axis) const {
    const Scalar R = noise_variance_m2(axis);
    return adaptive_ && (R <= lowest_R_ * Scalar(1.001) || R >= highest_R_ * Scalar(0.999));
  }

  /// Number of members.
  int member_count() const { return member_count_; }
  /// Member `i` after the last sample.
  const Step& step(int i) const { return members_[i].step; }

 private:
  // Members of the adaptive bank: log10 r = 6.5, 7, ..., 13.
  static constexpr Array<double, kMostMembers> kRatios = {
      3.1622776601683795e6,  1e7,  3.1622776601683795e7,  1e8,  3.1622776601683795e8,  1e9,
      3.1622776601683795e9,  1e10, 3.1622776601683795e10, 1e11, 3.1622776601683795e11, 1e12,
      3.1622776601683795e12, 1e13};
  static constexpr Scalar kFirstSamples = 5;  // samples that the first guess of R counts as
  static constexpr int kFewestLearned = 15;   // then a first guess is forgotten
  static constexpr Scalar kGrowth = Scalar(1) / Scalar(3);
  static constexpr Scalar kIndependentShare = Scalar(0.3);
  static constexpr Scalar kLead = 8;
  static constexpr Scalar kShortMemory = 8;           // samples
  static constexpr Scalar kPlausible = Scalar(1e-3);  // least weight that has a say
  static constexpr Scalar kExcuses = Scalar(0.01);    // and that can excuse an unexpected sample
  static constexpr Scalar kHopeless = -20;            // log weight behind the best

  struct Member {
    Scalar r{};
    Scalar mean_log_S{};
    Array<Scalar, kAxes> R = {};
    Array<Scalar, kAxes> log_R = {};
    Array<Scalar, kAxes> short_score = {};
    Array<Scalar, kAxes> weight = {};
    Step step;
  };

  static Scalar square(double value) { return static_cast<Scalar>(value * value); }

  // Counts one more sample, `T` s after the last; its share in the means.
  Scalar grow_memory(Scalar T) {
    n_ += kGrowth;
    mean_step_s_ += (T - mean_step_s_) / n_;
    // Compared without a division: steps may be 0.
    if (n_ * mean_step_s_ > memory_s_) n_ = std::max(memory_s_ / mean_step_s_, kFirstSamples);
    return Scalar(1) / n_;
  }

  // A noise that samples keep exceeding is still on its way up from the guess.
  void judge_guess(const Position& z_m) {
    bool is_within = true;
    for (int axis = 0; axis < kAxes; ++axis) {
      const Member& member = leader(axis);
      const Scalar innovation_m = z_m[axis] - member.step.x[axis][kPosition];
      const Scalar S = member.step.P(kPosition, kPosition) + Scalar(1);
      is_within = is_within && innovation_m * innovation_m <= largest_share_ * member.R[axis] * S;
    }
    learned_ = is_within ? learned_ + 1 : std::max(learned_ - 1, 0);
  }

  void weigh(int axis, const Array<Array<Scalar, kAxes>, kMostMembers>& long_score) {
    leader_[axis] = 0;
    for (int i = 1; i < member_count_; ++i) {
      if (long_score[i][axis] > long_score[leader_[axis]][axis]) leader_[axis] = i;
    }
    const Scalar best_long = long_score[leader_[axis]][axis];
    Array<Scalar, kMostMembers> score;
    Scalar best = -std::numeric_limits<Scalar>::infinity();
    for (int i = 0; i < member_count_; ++i) {
      score[i] = std::max(long_score[i][axis] - best_long, -kLead) + members_[i].short_score[axis];
      best = std::max(best, score[i]);
    }
    Scalar sum = 0;
    for (int i = 0; i < member_count_; ++i) {
      const Scalar behind = score[i] - best;
      members_[i].weight[axis] = behind < kHopeless ? Scalar(0) : elementary::exp(behind);
      sum += members_[i].weight[axis];
    }
    const Scalar inverse_sum = Scalar(1) / sum;
    for (int i = 0; i < member_count_; ++i) members_[i].weight[axis] *= inverse_sum;
  }

  MotionMoments<Scalar> filtered_moments(int i, int axis) const {
    const Step& step = members_[i].step;
    return {step.x[axis], {step.P(0, 0), step.P(1, 1), step.P(2, 2)}};
  }

  Scalar uncertainty_of_noise() const { return adaptive_ ? n_ / (n_ - Scalar(2)) : Scalar(1); }

  // R' of a member, see above.
  Scalar stated_R(const Member& member, int axis) const {
    return adaptive_ ? std::max(member.R[axis], leader(axis).R[axis]) : member.R[axis];
  }

  // The member that served best over the memory.
  const Member& leader(int axis) const { return members_[leader_[axis]]; }

  bool adaptive_;
  Scalar memory_s_, jerk_density_m2_s5_, lowest_R_, highest_R_;
  Scalar prior_velocity_variance_, prior_acceleration_variance_;
  Scalar largest_share_, largest_deviation_;
  int member_count_;
  Scalar n_ = kFirstSamples;
  Scalar mean_step_s_ = 0;
  int learned_ = 0;  // samples within huber, less those beyond
  Array<int, kAxes> leader_ = {};
  Array<Member, kMostMembers> members_;
};

}  // namespace condyle
