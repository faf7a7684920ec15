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
// numbers,
//            held between floor and ceiling. Then q_i = r_i R_i. Each nu^2 / S counts at most
//            huber^2 R_i, so that glitches do not become noise.
// Weights.   log likelihood of member i = -n/2 (log R_i + <log S_i>), and w_i proportional to its
//            exponential, the likelihood tempered: jaw motion is no white jerk, so innovations are
//            correlated, and n of them count as kIndependentShare n.
// Estimate.  Mean of the mixture: sum w_i x_i; variance sum w_i (R_i P_i + (x_i - mean)^2), times
//            n/(n-2) because R was estimated from n samples (Student's t).
//
// D. T. Magill, Optimal adaptive estimation of sampled stochastic processes, IEEE Trans. Autom.
// Control 10 (1965) 434-439 (the bank); the tracking index r T^5: P. R. Kalata, IEEE Trans. Aerosp.
// Electron. Syst. 20 (1984) 174-182. Tempering and its share are this project's: on simulated
// chewing (tests/consistency/recommended_motion_test.cpp) it lowers the velocity error.
#pragma once

#include <algorithm>

#include "condyle/estimator/elementary.h"
#include "condyle/estimator/fixed_lag.h"
#include "condyle/estimator/recommended_parameters.h"
#include "condyle/estimator/white_jerk.h"

namespace condyle {

/// State and variances along one axis: position, velocity, acceleration.
template <class Scalar>
struct MotionMoments {
  Vector3<Scalar> mean = Vector3<Scalar>::Zero();      ///< m, m/s, m/s^2
  Vector3<Scalar> variance = Vector3<Scalar>::Zero();  ///< squares of those
};

/// What the bank expects of the next measurement along one axis.
template <class Scalar>
struct Expectation {
  Scalar position_m{};         ///< mean of the mixture
  Scalar variance_m2{};        ///< of the innovation
  Scalar deviation_squared{};  ///< innovation^2 / variance of the plausible member it fits best
};

/// The bank. `kAxes`: 1 or 3.
template <class Scalar, int kAxes>
class MotionBank {
 public:
  /// Most members.
  static constexpr int kMostMembers = 11;
  using Position = Scalar[std::size_t{kAxes}];
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
        member_count_(adaptive_ ? kMostMembers : kAxes) {}

  /// Starts noise and weights: `noise_sd_m` is the instrument's noise, or the first guess of it.
  void start_noise(const Position& noise_sd_m) {
    n_ = kFirstSamples;
    for (int i = 0; i < member_count_; ++i) {
      Member& member = members_[i];
      member.mean_log_S = 0;
      for (int axis = 0; axis < kAxes; ++axis) {
        const Scalar R = noise_sd_m[axis] * noise_sd_m[axis];
        member.R[axis] = adaptive_ ? std::clamp(R, lowest_R_, highest_R_) : R;
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
    expected.deviation_squared = std::numeric_limits<Scalar>::infinity();
    for (int i = 0; i < member_count_; ++i) {
      const Member& member = members_[i];
      const Scalar weight = member.weight[axis];
      if (!(weight > kPlausible)) continue;
      const Scalar innovation_m = z_m - member.step.x[axis][kPosition];
      const Scalar variance_m2 = member.R[axis] * (member.step.P(kPosition, kPosition) + Scalar(1));
      weight_sum += weight;
      expected.position_m += weight * member.step.x[axis][kPosition];
      expected.variance_m2 += weight * variance_m2;
      expected.deviation_squared =
          std::min(expected.deviation_squared, innovation_m * innovation_m / variance_m2);
    }
    expected.position_m /= weight_sum;
    expected.variance_m2 /= weight_sum;
    return expected;
  }

  /// Learns noise and weights from the measurement `z_m`, `T` s after the last, after `predict`.
  void learn(const Position& z_m, Scalar T) {
    if (!adaptive_) return;
    const Scalar kept = std::max(Scalar(1) - T / memory_s_, kLeastKept);
    n_ = std::max(n_ * kept, kFirstSamples - 1) + Scalar(1);
    const Scalar gain = Scalar(1) / n_;
    Scalar score[std::size_t{kMostMembers}][std::size_t{kAxes}];
    Scalar best_score[std::size_t{kAxes}];
    for (Scalar& best : best_score) best = -std::numeric_limits<Scalar>::infinity();
    for (int i = 0; i < member_count_; ++i) {
      Member& member = members_[i];
      const Scalar S = member.step.P(kPosition, kPosition) + Scalar(1);
      const Scalar inverse_S = Scalar(1) / S;
      member.mean_log_S += gain * (elementary::log(S) - member.mean_log_S);
      for (int axis = 0; axis < kAxes; ++axis) {
        const Scalar innovation_m = z_m[axis] - member.step.x[axis][kPosition];
        Scalar& R = member.R[axis];
        const Scalar share = std::min(innovation_m * innovation_m * inverse_S, largest_share_ * R);
        R = std::clamp(R + gain * (share - R), lowest_R_, highest_R_);
        score[i][axis] =
            Scalar(-0.5) * kIndependentShare * n_ * (elementary::log(R) + member.mean_log_S);
        best_score[axis] = std::max(best_score[axis], score[i][axis]);
      }
    }
    for (int axis = 0; axis < kAxes; ++axis) {
      Scalar sum = 0;
      for (int i = 0; i < member_count_; ++i) {
        const Scalar behind = score[i][axis] - best_score[axis];
        members_[i].weight[axis] = behind < kHopeless ? Scalar(0) : elementary::exp(behind);
        sum += members_[i].weight[axis];
      }
      const Scalar inverse_sum = Scalar(1) / sum;
      for (int i = 0; i < member_count_; ++i) members_[i].weight[axis] *= inverse_sum;
    }
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
      mixed.variance += weight * members_[i].R[axis] * moments.variance;
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

  /// Variance of the noise along `axis` (m^2), as estimated or given.
  Scalar noise_variance_m2(int axis) const {
    return weighted(axis, [axis](const Member& member) { return member.R[axis]; });
  }
  /// Density of the jerk along `axis` (m^2/s^5), as estimated or given.
  Scalar jerk_density_m2_s5(int axis) const {
    return weighted(axis, [axis](const Member& member) { return member.r * member.R[axis]; });
  }
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
  // Members of the adaptive bank: log10 r = 6.5, 7, ..., 11.5.
  static constexpr double kRatios[kMostMembers] = {
      3.1622776601683795e6, 1e7,  3.1622776601683795e7,  1e8,  3.1622776601683795e8, 1e9,
      3.1622776601683795e9, 1e10, 3.1622776601683795e10, 1e11, 3.1622776601683795e11};
  static constexpr Scalar kFirstSamples = 5;         // samples that the first guess counts as
  static constexpr Scalar kLeastKept = Scalar(0.9);  // a gap forgets no more than this
  static constexpr Scalar kIndependentShare = Scalar(0.3);
  static constexpr Scalar kPlausible = Scalar(1e-3);  // least weight that has a say
  static constexpr Scalar kHopeless = -20;            // log likelihood behind the best

  struct Member {
    Scalar r{};
    Scalar mean_log_S{};
    Scalar R[std::size_t{kAxes}] = {};
    Scalar weight[std::size_t{kAxes}] = {};
    Step step;
  };

  static Scalar square(double value) { return static_cast<Scalar>(value * value); }

  MotionMoments<Scalar> filtered_moments(int i, int axis) const {
    const Step& step = members_[i].step;
    return {step.x[axis], {step.P(0, 0), step.P(1, 1), step.P(2, 2)}};
  }

  Scalar uncertainty_of_noise() const { return adaptive_ ? n_ / (n_ - Scalar(2)) : Scalar(1); }

  template <class ValueOf>
  Scalar weighted(int axis, const ValueOf& value_of) const {
    Scalar sum = 0;
    for (int i = 0; i < member_count_; ++i) sum += members_[i].weight[axis] * value_of(members_[i]);
    return sum;
  }

  bool adaptive_;
  Scalar memory_s_, jerk_density_m2_s5_, lowest_R_, highest_R_;
  Scalar prior_velocity_variance_, prior_acceleration_variance_;
  Scalar largest_share_;
  int member_count_;
  Scalar n_ = kFirstSamples;
  Member members_[kMostMembers];
};

}  // namespace condyle
