// SPDX-License-Identifier: Apache-2.0
// Kalman filter of a point that muscles drive: its position, velocity, damping, stiffness and the
// muscles' gains, each per unit of mass.
//
//   z         measured position (m)
//   F_n       force of muscle n along the followed axis at gain 1 (N), muscle_force.h; linear from
//             sample to sample
//   x         state: p, v, d, lambda, kappa, c, g_1 ... g_8
//   d         force that the F_n miss or make up, per mass (m/s^2)
//   lambda    kv / m,  kappa = ks / m,  c = constant force / m,  g_n = K_n / m
//   P         covariance of x
//
// Model:       p' = v,  v' = sum g_n F_n + d + c - lambda v - kappa p      (eqs 2 and 9, corrected)
//              d' = -d / tau + white, of standard deviation s rms(F), with
//              rms(F)^2 = mean of (sum |g_n F_n|)^2 + d^2, of the fitted or of the prior's gains,
//              whichever is more; s is learned from the innovations, so that their mean NIS is 1
//              (too large an s gives too much friction, too small an s too little)
//              lambda, kappa, c, g_n   constants
// Prediction:  by mass_spring_damper.h with the drive sum g_n F_n + d of a mass of 1; P <- F P F' +
// Q + B
//                Q   of lowest order in T / tau, q = 2 (s rms F)^2 / tau:
//                    Q_dd = q T, Q_vd = q T^2 / 2, Q_vv = q T^3 / 3, Q_pd = q T^3 / 6,
//                    Q_pv = q T^4 / 8, Q_pp = q T^5 / 20
//                B   what the products lambda v and kappa p of two unknowns add beyond their
//                    linear part, of normal x: B_vv = T^2 sum (P_aa P_bb + P_ab^2),
//                    B_pv = T B_vv / 2, B_pp = T^2 B_vv / 4
// Update:      for z, the single state p: S = P_pp + R, K = P_.p / S, P <- P - S K K'
#pragma once

#include "condyle/estimator/emg/correlated_model_error.h"
#include "condyle/estimator/emg/emg_estimate.h"
#include "condyle/estimator/emg/emg_parameters.h"
#include "condyle/estimator/impedance/mass_spring_damper.h"
#include "condyle/estimator/math/innovation_monitor.h"
#include "condyle/estimator/math/symmetric_matrix.h"

namespace condyle {

/// The filter. Fixed size, no allocation; see above.
template <class Scalar>
class EmgFilter {
 public:
  using Forces = std::array<Scalar, kMostMuscles>;
  /// Position and velocity of the point.
  struct Place {
    Scalar position_m = 0, velocity_m_s = 0;
    bool is_known = false;
  };

  /// `parameters` must be valid. At most kMostMuscles of `muscles` are used; the first forces are
  /// given.
  EmgFilter(const EmgParameters& parameters, std::size_t muscles)
      : parameters_(parameters), muscles_(static_cast<int>(muscles)) {
    set_prior();
  }

  /// The forces change to `F` (N), of gain 1 along the followed axis, within `T` s; T > 0, not used
  /// for the first forces. The previous interval is completed.
  void drive(Scalar T, const Forces& F) {
    complete();
    if (has_drive_) {
      before_ = after_;
      interval_s_ = T;
      share_ = Scalar(0);
    } else {
      share_ = Scalar(1);
    }
    after_ = F;
    has_drive_ = true;
  }

  /// Completes the interval; then the state `T` s after its end for constant forces.
  Place complete(Scalar T = Scalar(0)) {
    advance(Scalar(1));
    if (!is_started_) return {};
    return {x_[p] + T * x_[v], x_[v] + T * acceleration(drive_at(Scalar(1)) + x_[d]), true};
  }

  /// A position `z` (m) with noise of standard deviation `sd` (m), measured when the share `share`
  /// (0 to 1) of the present interval has passed; not earlier than the previous one.
  EmgOutcome measure(Scalar share, Scalar z, Scalar sd) {
    nis_ = std::numeric_limits<Scalar>::quiet_NaN();
    if (!has_drive_) return outcome_ = EmgOutcome::waits;
    if (!is_started_) {
      share_ = share;
      start(z, square(sd));
      return outcome_ = EmgOutcome::started;
    }
    advance(share);
    outcome_ = update(z, square(sd));
    if (outcome_ == EmgOutcome::refused || !is_usable()) {
      interrupt();
      set_prior();
      ++restarts_;
      outcome_ = EmgOutcome::refused;
    }
    return outcome_;
  }

  /// Forgets position and forces, but not the identified values.
  void interrupt() { is_started_ = has_drive_ = false; }

  EmgOutcome outcome() const { return outcome_; }
  Scalar nis() const { return nis_; }  ///< of the last position; NaN if it was not used
  const InnovationMoments<Scalar>& monitor() const { return monitor_; }
  std::uint64_t restarts() const { return restarts_; }
  Scalar noise_share() const { return noise_share_; }  ///< s
  Scalar rejected_share() const {
    return positions_ > Scalar(0) ? rejected_ / positions_ : Scalar(0);
  }
  Scalar found_error_share() const {  ///< rms d / rms F
    using std::sqrt;
    return powers_.F2 > Scalar(0) ? sqrt(powers_.d2 / powers_.F2) : Scalar(0);
  }

 protected:
  enum { p, v, d, lambda, kappa, c, g, kStates = g + static_cast<int>(kMostMuscles) };
  static constexpr int kValues = kStates - lambda;  // the constant ones
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Values = typename CorrelatedModelError<Scalar, kValues>::Vector;
  // Means over all time: of force_power(F), d^2, v^2 and v'^2.
  struct Powers {
    Scalar time_s = 0, F2 = 0, d2 = 0, v2 = 0, a2 = 0;
  };

  static Scalar square(Scalar value) { return value * value; }
  const EmgPrior& prior_of(int state) const {
    if (state == lambda) return parameters_.friction_Ns_m;
    if (state == kappa) return parameters_.stiffness_N_m;
    return state == c ? parameters_.offset_N : parameters_.gain;
  }
  const EmgParameters& parameters() const { return parameters_; }
  int muscles() const { return muscles_; }
  const State& x() const { return x_; }
  const SymmetricMatrix<Scalar, kStates>& P() const { return P_; }
  const Powers& powers() const { return powers_; }
  const CorrelatedModelError<Scalar, kValues>& correlated_error() const {
    return correlated_error_;
  }

 private:
  static constexpr Scalar kLowestShare = Scalar(1e-4), kFirstShare = Scalar(0.1);
  static constexpr int kMostRejected = 3, kMuscles = static_cast<int>(kMostMuscles);

  // The priors of kv, ks, b and K_n, converted to values per mass: x = k / m has the variance
  // E[m^-2] var k + k^2 var 1/m.
  void set_prior() {
    x_.setZero();
    P_ = {};
    monitor_ = {};
    positions_ = rejected_ = Scalar(0);
    const Scalar stated = Scalar(parameters_.error_share);
    noise_share_ = stated < kFirstShare ? stated : kFirstShare;
    powers_ = {};
    correlated_error_ = {};
    const Scalar e = Scalar(1) / Scalar(parameters_.mass_kg.mean);
    const Scalar e_variance = square(e * e * Scalar(parameters_.mass_kg.sd));
    for (int i = lambda; i < g + muscles_; ++i) {
      const Scalar k = Scalar(prior_of(i).mean);
      x_[i] = k * e;
      for (int j = lambda; j <= i; ++j) P_(i, j) = k * Scalar(prior_of(j).mean) * e_variance;
      P_(i, i) += (e * e + e_variance) * square(Scalar(prior_of(i).sd));
    }
  }

  void start(Scalar z, Scalar R) {
    x_[p] = z;
    x_[v] = x_[d] = Scalar(0);
    for (const int i : {p, v, d}) P_.clear_entry(i);
    P_(p, p) = R;
    P_(v, v) = square(Scalar(parameters_.velocity_sd_m_s));
    P_(d, d) = error_variance(after_);
    rejected_in_a_row_ = 0;
    is_started_ = true;
  }

  Scalar force_at(Scalar share, int n) const {
    const auto i = static_cast<std::size_t>(n);
    return before_[i] + share * (after_[i] - before_[i]);
  }
  // Per mass.
  Scalar drive_at(Scalar share) const {
    Scalar sum = 0;
    for (int n = 0; n < muscles_; ++n) sum += x_[g + n] * force_at(share, n);
    return sum;
  }
  Scalar acceleration(Scalar drive) const {
    return drive + x_[c] - x_[lambda] * x_[v] - x_[kappa] * x_[p];
  }
  // (sum |g_n F_n|)^2 + d^2
  Scalar force_power(const Forces& F) const {
    using std::abs;
    const Scalar prior = Scalar(parameters_.gain.mean / parameters_.mass_kg.mean);
    Scalar fitted_sum = 0, prior_sum = 0;
    for (int n = 0; n < muscles_; ++n) {
      const Scalar force = abs(F[static_cast<std::size_t>(n)]);
      fitted_sum += abs(x_[g + n]) * force;
      prior_sum += prior * force;
    }
    return square(fitted_sum > prior_sum ? fitted_sum : prior_sum) + square(x_[d]);
  }
  Scalar error_variance(const Forces& F) const {
    return square(noise_share_) * (powers_.time_s > Scalar(0) ? powers_.F2 : force_power(F));
  }

  // Advances to the share `end` of the present interval.
  void advance(Scalar end) {
    const Scalar T = (end - share_) * interval_s_;
    if (!(T > Scalar(0))) return;
    if (is_started_) predict(T, share_, end);
    share_ = end;
  }

  void predict(Scalar T, Scalar begin, Scalar end) {
    add_powers(T, end);
    const DrivenRates<Scalar> rates{x_[lambda], Scalar(1), x_[kappa], x_[c]};
    const Scalar tau = Scalar(parameters_.error_time_s);
    const Scalar kept = elementary::exp(-T / tau);  // of d
    const DrivenStep<Scalar> step =
        driven_step(rates, driven_response(rates, T), x_[p], x_[v], drive_at(begin) + x_[d],
                    drive_at(end) + kept * x_[d]);
    // Rows p and v of F, in the order of the state.
    Eigen::Matrix<Scalar, 2, kStates> F, B;
    const typename DrivenStep<Scalar>::Row* const of[] = {&step.position, &step.velocity};
    for (int row = 0; row < 2; ++row) {
      const auto& entries = *of[row];
      const Scalar before = entries[kOfDriveBefore], after = entries[kOfDrive];
      F(row, p) = entries[kOfPosition];
      F(row, v) = entries[kOfVelocity];
      F(row, d) = before + kept * after;
      F(row, lambda) = entries[kOfLambda];
      F(row, kappa) = entries[kOfKappa];
      F(row, c) = entries[kOfOffset];
      for (int n = 0; n < kMuscles; ++n) {
        F(row, g + n) = before * force_at(begin, n) + after * force_at(end, n);
      }
      for (int j = 0; j < kStates; ++j) {  // B = F P
        Scalar sum = 0;
        for (int i = 0; i < kStates; ++i) sum += F(row, i) * P_(i, j);
        B(row, j) = sum;
      }
    }
    const Scalar q = Scalar(2) * error_variance(after_) / tau, T2 = T * T, T3 = T2 * T;
    const Scalar b = T * T * (of_product(lambda, v) + of_product(kappa, p));
    P_(p, p) = B.row(0).dot(F.row(0)) + q * T3 * T2 / Scalar(20) + b * T2 / Scalar(4);
    P_(p, v) = B.row(0).dot(F.row(1)) + q * T2 * T2 / Scalar(8) + b * T / Scalar(2);
    P_(v, v) = B.row(1).dot(F.row(1)) + q * T3 / Scalar(3) + b;
    for (int j = d; j < kStates; ++j) {
      const Scalar share = j == d ? kept : Scalar(1);
      P_(p, j) = share * B(0, j);
      P_(v, j) = share * B(1, j);
      P_(d, j) *= j == d ? kept * kept : kept;
    }
    P_(p, d) += q * T3 / Scalar(6);
    P_(v, d) += q * T2 / Scalar(2);
    P_(d, d) += q * T;
    x_[p] = step.position[kSolution];
    x_[v] = step.velocity[kSolution];
    x_[d] *= kept;
  }

  // Variance of the product of two states beyond its linear part.
  Scalar of_product(int i, int j) const { return P_(i, i) * P_(j, j) + square(P_(i, j)); }

  EmgOutcome update(Scalar z, Scalar R) {
    using std::sqrt;
    const Scalar S = P_(p, p) + R;
    if (!(S > S - S)) return EmgOutcome::refused;
    const Scalar innovation = z - x_[p];
    nis_ = innovation * innovation / S;
    positions_ += Scalar(1);
    if (!(nis_ <= square(Scalar(parameters_.gate_sd)))) {
      rejected_ += Scalar(1);
      monitor_.add(std::numeric_limits<Scalar>::quiet_NaN());
      if (++rejected_in_a_row_ == kMostRejected) is_started_ = false;
      return EmgOutcome::rejected;
    }
    monitor_.add(innovation / sqrt(S));
    learn_noise();
    rejected_in_a_row_ = 0;
    State K;
    for (int i = 0; i < kStates; ++i) K[i] = P_(i, p) / S;
    x_ += K * innovation;
    P_.take_off(S, K);
    return EmgOutcome::updated;
  }

  // Steers the NIS towards 1; large deviations count as 3 standard deviations.
  void learn_noise() {
    constexpr Scalar kFirst = Scalar(1) / Scalar(50), kLast = Scalar(1) / Scalar(400);
    const Scalar one = Scalar(1) / (monitor_.count() + Scalar(50));
    const Scalar weight = one > kFirst ? kFirst : one < kLast ? kLast : one;
    const Scalar excess = (nis_ < Scalar(9) ? nis_ : Scalar(9)) - Scalar(1);
    noise_share_ *= elementary::exp(weight * excess);
    noise_share_ = noise_share_ < kLowestShare ? kLowestShare : noise_share_;
  }

  bool is_usable() const {
    const Scalar sum = x_.sum();
    return sum - sum == Scalar(0);
  }

  // Means over all time.
  void add_powers(Scalar T, Scalar end) {
    powers_.time_s += T;
    const Scalar weight = T / powers_.time_s;
    const auto add = [weight](Scalar& mean, Scalar value) { mean += weight * (value - mean); };
    Forces F{};
    Values y = Values::Zero();
    y[lambda - lambda] = x_[v];
    y[kappa - lambda] = x_[p];
    y[c - lambda] = Scalar(1);
    for (int n = 0; n < muscles_; ++n) {
      F[static_cast<std::size_t>(n)] = y[g - lambda + n] = force_at(end, n);
    }
    add(powers_.F2, force_power(F));
    add(powers_.d2, square(x_[d]));
    add(powers_.v2, square(x_[v]));
    add(powers_.a2, square(acceleration(drive_at(end) + x_[d])));
    correlated_error_.add(y, weight);
  }

  EmgParameters parameters_;
  int muscles_;
  State x_ = State::Zero();
  SymmetricMatrix<Scalar, kStates> P_;
  InnovationMoments<Scalar> monitor_;
  EmgOutcome outcome_ = EmgOutcome::waits;
  Scalar nis_ = std::numeric_limits<Scalar>::quiet_NaN();
  bool has_drive_ = false, is_started_ = false;
  Forces before_{}, after_{};
  Scalar interval_s_ = 0, share_ = 1;  // of the forces; the share that has passed
  int rejected_in_a_row_ = 0;
  Scalar positions_ = 0, rejected_ = 0;
  Scalar noise_share_ = kFirstShare;
  std::uint64_t restarts_ = 0;
  Powers powers_;
  CorrelatedModelError<Scalar, kValues> correlated_error_;
};

}  // namespace condyle
