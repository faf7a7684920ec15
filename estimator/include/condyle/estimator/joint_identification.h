// SPDX-License-Identifier: Apache-2.0
// Friction and mass of a point whose total drive is known, from its position.
//
//   z, u      measured position (m) and drive (N)
//   x         state: p, v, u0 and u1 (drive at the begin and the end of an interval of the drive),
//             lambda, eta, kappa, tau, c, gamma (driven_point.h)
//   A         covariance of x
//   kv, m     effective damping lambda / eta (Ns/m), mass 1 / eta (kg)
//   ks, b     support stiffness kappa / eta (N/m), constant force c / eta (N)
//   Fc        Coulomb friction gamma / eta (N), a force -Fc tanh(v / vs)
//   tau       delay of the drive beyond the one that was taken off (s)
//   I         length of the drive's interval (s)
//
// Model:       p, v   follow driven_point.h, plus white force noise of density q_F:
//                     Q_pp = q T^3 / 3, Q_pv = q T^2 / 2, Q_vv = q T, q = q_F eta^2
//              u      what is measured is u + e, e white; it is a state because a measured drive
//                     moves the point before and after it: one error, that counts in both
//              lambda, eta, kappa, c, gamma   constants, or random walks given for kv, m, ks, b, Fc
// Drive:       u0 <- u1, u1 <- the next measured drive, of variance sigma_u^2. Linear between; at
//              the share s of the interval it was measured as u0 + (s + tau / I) (u1 - u0), and
//              tau^2 / 2 times its second derivative, where that is given
// Prediction:  within an interval of the drive, A <- F A F' + Q + B
//              Fc  acts with the mean of tanh over the step (smooth_sign.h), whose end is sought;
//                  that of a normal v is about tanh(v / (vs^2 + pi/2 A_vv)^1/2) (as of erf)
//              B   what the products eta u, lambda v and kappa p of two unknowns add to the
//                  acceleration beyond their linear part, of normal x and a constant over the step:
//                  B_vv = T^2 sum (A_aa A_bb + A_ab^2), B_pv = T B_vv / 2, B_pp = T^2 B_vv / 4, the
//                  products taken as independent; it matters in the first second only
// Update:      for z, the single state p: S = A_pp + R, K = A_.p / S, A <- A - S K K'
//              then x <- x + A s for what drive_noise_bias.h adds to the score of (lambda, eta,
//              kappa, tau): with r^2 = S for the filter at given parameters, s times r^2 / S of
//              this one (the Coulomb friction's derivatives are left out of it) Of a point that
//              hardly moved for a second only p, v, u0 and u1 are updated, the parameters are
//              considered (S. F. Schmidt, Adv. Control Syst. 3 (1966) 293)
// Prior:       m log-normal, its median and its relative sd r as given, so that eta has about
//              1 / median the second moment (w^2 - 2 w^1/2 + 1) / median^2, w = 1 + r^2; kv, ks, b
//              and Fc independent of m
//
// ks and b are always states: left out, a spring is taken for less mass (m - ks / w^2). All of this
// identifies the point up to one scale, g u = m a + kv v + ...: the drive's gain is never fitted.
// Observable unless u is proportional to v (Bogena et al. 2022, eq 24 with its input known; the
// block of orders 0 to 3 has determinant (v j - a^2) / m^2, j the jerk).
//
// What may be said of the values: joint_conclusion.h.
#pragma once

#include <numbers>

#include "condyle/estimator/drive_noise_bias.h"
#include "condyle/estimator/driven_point.h"
#include "condyle/estimator/joint_conclusion.h"
#include "condyle/estimator/smooth_sign.h"
#include "condyle/estimator/symmetric_matrix.h"

namespace condyle {

/// The filter. Fixed size, no allocation; see above.
template <class Scalar>
class JointIdentification {
 public:
  /// `parameters` must be valid.
  explicit JointIdentification(const JointParameters& parameters) : parameters_(parameters) {
    set_prior();
  }

  /// The drive is to go from where it is to `u` (N), measured `T` s later; T > 0, not used for the
  /// first one. The interval before is completed. `curvature`: its second derivative there (N/s^2),
  /// for a delay that is fitted.
  void drive(Scalar T, Scalar u, Scalar curvature = Scalar(0)) {
    advance(Scalar(1));
    if (has_drive_) {
      x_[u0] = x_[u1];
      A_.move_entry(u1, u0);
      interval_s_ = T;
      share_ = Scalar(0);
      clock_s_ += T;
    } else {
      A_.clear_entry(u1);
      share_ = Scalar(1);
    }
    curvature_[0] = curvature_[1];
    curvature_[1] = curvature;
    x_[u1] = u;
    A_(u1, u1) = square(Scalar(parameters_.drive.noise_sd_N));
    bias_.drive(A_(u1, u1));
    has_drive_ = true;
  }

  /// A position `z` (m) with noise of standard deviation `sd` (m), measured when the share `share`
  /// (0 to 1) of the present interval has passed; not earlier than the one before.
  JointFilterEstimate<Scalar> measure(Scalar share, Scalar z, Scalar sd) {
    Scalar nis = std::numeric_limits<Scalar>::quiet_NaN();
    if (!has_drive_) return estimate(JointOutcome::waits, nis);
    if (!is_started_) {
      if (is_contact(z)) return estimate(JointOutcome::paused, nis);
      share_ = share;
      start(z, square(sd));
      return estimate(JointOutcome::started, nis);
    }
    advance(share);
    if (is_contact(z)) {
      is_started_ = is_lost_ = false;
      return estimate(JointOutcome::paused, nis);
    }
    JointOutcome outcome = update(z, square(sd), nis);
    if (outcome == JointOutcome::refused || !is_usable()) {
      reset();
      has_failed_ = true;
      outcome = JointOutcome::refused;
    }
    return estimate(outcome, nis);
  }

  /// Drive and position measured at once, `T` s after the ones before: drive(T, u), measure(1, z,
  /// sd).
  JointFilterEstimate<Scalar> step(Scalar T, Scalar u, Scalar z, Scalar sd) {
    drive(T, u);
    return measure(Scalar(1), z, sd);
  }

  /// Forgets where the point is and what drives it, not what is known of it: after a contact, or a
  /// gap without drive.
  void interrupt() { is_started_ = has_drive_ = false; }

  /// What is known now.
  JointFilterEstimate<Scalar> estimate() const {
    return estimate(JointOutcome::waits, std::numeric_limits<Scalar>::quiet_NaN());
  }

  /// Covariance of the state, in the order of the model.
  const SymmetricMatrix<Scalar, 10>& covariance() const { return A_; }

 private:
  static constexpr int kMostRejected = 3, kSettled = 20;
  static constexpr Scalar kLost_s = 1, kLongLost_s = 3, kMotion_s = 1;

  enum { p, v, u0, u1, lambda, eta, kappa, tau, c, gamma, kStates };
  using State = Eigen::Matrix<Scalar, kStates, 1>;

  static Scalar square(Scalar value) { return value * value; }

  bool is_contact(Scalar z) const {
    return z > Scalar(parameters_.contact_above_m) || z < Scalar(parameters_.contact_below_m);
  }

  // Forgets all.
  void reset() {
    interrupt();
    set_prior();
  }

  // The priors of kv, m, ks, b, Fc as those of lambda, eta, kappa, c, gamma: x = k eta has the
  // variance E[eta^2] var k + k^2 var eta.
  void set_prior() {
    using std::sqrt;
    x_.setZero();
    A_ = {};
    monitor_ = {};
    is_lost_ = false;
    clock_s_ = motion_ = Scalar(0);
    time_s_ = sum_p_ = sum_p2_ = sum_u2_ = sum_v2_ = sum_a2_ = 0;
    const Scalar e = Scalar(1) / Scalar(parameters_.mass_kg.mean);
    const Scalar w = Scalar(1) + square(e * Scalar(parameters_.mass_kg.sd));
    const Scalar e_variance = e * e * (w * w - Scalar(2) * sqrt(w) + Scalar(1));
    x_[eta] = e;
    A_(eta, eta) = e_variance;
    if (parameters_.delay == DelayModel::fitted) {
      A_(tau, tau) = square(Scalar(parameters_.drive.delay_sd_s));
    }
    const JointPrior* const priors[] = {&parameters_.friction_Ns_m, &parameters_.stiffness_N_m,
                                        &parameters_.offset_N, &parameters_.coulomb_N};
    constexpr int states[] = {lambda, kappa, c, gamma};
    for (int i = 0; i < 4; ++i) {
      const Scalar k = Scalar(priors[i]->mean);
      x_[states[i]] = k * e;
      A_(states[i], eta) = k * e_variance;
      for (int j = 0; j <= i; ++j) {
        A_(states[i], states[j]) = k * Scalar(priors[j]->mean) * e_variance;
      }
      A_(states[i], states[i]) += (e * e + e_variance) * square(Scalar(priors[i]->sd));
    }
  }

  void start(Scalar z, Scalar R) {
    x_[p] = z;
    x_[v] = 0;
    A_.clear_entry(p);
    A_.clear_entry(v);
    A_(p, p) = R;
    A_(v, v) = square(Scalar(parameters_.velocity_sd_m_s));
    rejected_in_a_row_ = taken_in_a_row_ = 0;
    bias_.start(A_(p, p), A_(v, v));
    is_started_ = true;
  }

  // To the share `end` of the present interval.
  void advance(Scalar end) {
    const Scalar T = (end - share_) * interval_s_;
    if (!(T > Scalar(0))) return;
    if (is_started_) predict(T, share_, end);
    share_ = end;
  }

  void predict(Scalar T, Scalar begin, Scalar end) {
    const Scalar later = x_[tau] / interval_s_;
    begin += later;
    end += later;
    const Scalar curvature = (curvature_[0] + curvature_[1]) / Scalar(2);
    const Scalar curved = square(x_[tau]) / Scalar(2) * curvature;
    const auto drive_at = [&](Scalar share) { return x_[u0] + share * (x_[u1] - x_[u0]) + curved; };
    DrivenRates<Scalar> rates{x_[lambda], x_[eta], x_[kappa], x_[c]};
    const DrivenResponse<Scalar> response = driven_response(rates, T);
    const auto step_with = [&](Scalar acceleration) {
      rates.c = acceleration;
      return driven_step(rates, response, x_[p], x_[v], drive_at(begin), drive_at(end));
    };
    DrivenStep<Scalar> step = step_with(x_[c]);
    MeanSign<Scalar> sign;
    const bool has_coulomb = A_(gamma, gamma) > Scalar(0) || x_[gamma] > Scalar(0);
    if (has_coulomb) {
      using std::sqrt;
      const Scalar vs = sqrt(square(Scalar(parameters_.coulomb_velocity_m_s)) +
                             Scalar(std::numbers::pi / 2) * A_(v, v));
      const Scalar most = x_[gamma] > Scalar(0) ? x_[gamma] * step.velocity[kOfOffset] : Scalar(0);
      sign = mean_sign(x_[v], braked_velocity(x_[v], step.velocity[kSolution], most, vs), vs);
      step = step_with(x_[c] - x_[gamma] * sign.value);
    }
    // Rows p and v of F, in the order of the state.
    const Scalar slope = (x_[u1] - x_[u0]) / interval_s_ + x_[tau] * curvature;
    const auto row_of = [&](const typename DrivenStep<Scalar>::Row& of) {
      Eigen::Matrix<Scalar, 1, kStates> row;
      row << of[kOfPosition], of[kOfVelocity],
          (Scalar(1) - begin) * of[kOfDriveBefore] + (Scalar(1) - end) * of[kOfDrive],
          begin * of[kOfDriveBefore] + end * of[kOfDrive], of[kOfLambda], of[kOfEta], of[kOfKappa],
          slope * (of[kOfDriveBefore] + of[kOfDrive]), of[kOfOffset], -sign.value * of[kOfOffset];
      return row;
    };
    Eigen::Matrix<Scalar, 2, kStates> F, B;
    F.row(0) = row_of(step.position);
    F.row(1) = row_of(step.velocity);
    if (has_coulomb) {  // M of the step's begin and end: dv1 = F dx - gamma R (M_0 dv0 + M_1 dv1)
      const Scalar of_v = x_[gamma] * step.velocity[kOfOffset];
      const Scalar of_p = x_[gamma] * step.position[kOfOffset];
      F(1, v) -= of_v * sign.of_begin;
      F.row(1) /= Scalar(1) + of_v * sign.of_end;
      F(0, v) -= of_p * sign.of_begin;
      F.row(0) -= of_p * sign.of_end * F.row(1);
    }
    for (int row = 0; row < 2; ++row) {  // B = F A
      for (int j = 0; j < kStates; ++j) {
        Scalar sum = 0;
        for (int i = 0; i < kStates; ++i) sum += F(row, i) * A_(i, j);
        B(row, j) = sum;
      }
    }
    Scalar q = square(Scalar(parameters_.force_noise_N_root_s) * x_[eta]);
    if (has_coulomb) {  // what tanh of a normal v varies beyond its linear part, at most
      const Scalar r = A_(v, v) / (A_(v, v) + square(Scalar(parameters_.coulomb_velocity_m_s)));
      q += T * square(x_[gamma]) * (Scalar(1) - square(sign.value)) * r * r *
           Scalar(1 - 2 / std::numbers::pi);
    }
    bias_.predict(rates, response, begin, end, interval_s_, q, T);
    const Scalar b = T * T * (of_product(eta, u1) + of_product(lambda, v) + of_product(kappa, p));
    A_(p, p) = B.row(0).dot(F.row(0)) + q * T * T * T / Scalar(3) + b * T * T / Scalar(4);
    A_(p, v) = B.row(0).dot(F.row(1)) + q * T * T / Scalar(2) + b * T / Scalar(2);
    A_(v, v) = B.row(1).dot(F.row(1)) + q * T + b;
    for (int j = u0; j < kStates; ++j) {
      A_(p, j) = B(0, j);
      A_(v, j) = B(1, j);
    }
    const Scalar e = x_[eta];
    A_(lambda, lambda) += T * square(e * Scalar(parameters_.friction_Ns_m.walk_per_root_s));
    A_(eta, eta) += T * square(e * e * Scalar(parameters_.mass_kg.walk_per_root_s));
    A_(kappa, kappa) += T * square(e * Scalar(parameters_.stiffness_N_m.walk_per_root_s));
    A_(c, c) += T * square(e * Scalar(parameters_.offset_N.walk_per_root_s));
    A_(gamma, gamma) += T * square(e * Scalar(parameters_.coulomb_N.walk_per_root_s));
    x_[p] = step.position[kSolution];
    x_[v] = step.velocity[kSolution];
    add_powers(T, drive_at(end), rates.c);
  }

  // Variance of the product of two states beyond its linear part.
  Scalar of_product(int i, int j) const { return A_(i, i) * A_(j, j) + square(A_(i, j)); }

  JointOutcome update(Scalar z, Scalar R, Scalar& nis) {
    using std::sqrt;
    const Scalar S = A_(p, p) + R;
    if (!(S > S - S)) return JointOutcome::refused;
    const Scalar innovation = z - x_[p];
    nis = innovation * innovation / S;
    if (nis > square(Scalar(parameters_.gate_sd))) return reject();
    monitor_.add(innovation / sqrt(S));
    rejected_in_a_row_ = 0;
    if (++taken_in_a_row_ >= kSettled) is_lost_ = false;
    State K;
    for (int i = 0; i < kStates; ++i) K[i] = A_(i, p) / S;
    const bool moves = motion_ >= square(Scalar(parameters_.least_velocity_m_s));
    const int updated = moves ? static_cast<int>(kStates) : static_cast<int>(lambda);
    for (int i = 0; i < updated; ++i) {
      x_[i] += K[i] * innovation;
      for (int j = i; j < kStates; ++j) A_(i, j) -= S * K[i] * K[j];
    }
    const auto score = bias_.update(R);
    if (!moves) return JointOutcome::held;
    for (int i = 0; i < kStates; ++i) {
      for (int j = 0; j < bias_.kParameters; ++j) x_[i] += A_(i, lambda + j) * nis * score[j];
    }
    return JointOutcome::updated;
  }

  // A force that nobody measured acts, as of food: the point's place is sought anew. Where it is
  // not found within a second, the instrument may have slipped along the spring, or a load was laid
  // on: then the constant force is another one. Else, or for longer, all is wrong.
  JointOutcome reject() {
    monitor_.add(std::numeric_limits<Scalar>::quiet_NaN());
    taken_in_a_row_ = 0;
    if (++rejected_in_a_row_ < kMostRejected) return JointOutcome::rejected;
    is_started_ = false;
    if (!is_lost_) lost_at_s_ = clock_s_;
    is_lost_ = true;
    const Scalar lost_s = clock_s_ - lost_at_s_;
    if (lost_s < kLost_s) return JointOutcome::rejected;
    const JointConclusion<Scalar> conclusion(parameters_, monitor_);
    if (lost_s > kLongLost_s || !conclusion.is_judged() || !conclusion.model_holds()) {
      return JointOutcome::refused;
    }
    A_.clear_entry(c);
    A_(c, c) = square(x_[eta] * Scalar(parameters_.offset_N.sd));
    return JointOutcome::rejected;
  }

  // A mass below zero or beyond all bounds is none.
  bool is_usable() const {
    const Scalar sum = x_.sum();
    return sum - sum == Scalar(0) && x_[eta] > Scalar(1e-6);
  }

  void add_powers(Scalar T, Scalar u, Scalar constant) {
    const Scalar a = x_[eta] * u + constant - x_[lambda] * x_[v] - x_[kappa] * x_[p];
    time_s_ += T;
    sum_p_ += T * x_[p];
    sum_p2_ += T * x_[p] * x_[p];
    sum_u2_ += T * u * u;
    sum_v2_ += T * x_[v] * x_[v];
    sum_a2_ += T * a * a;
    const Scalar weight = T < kMotion_s ? T / kMotion_s : Scalar(1);
    motion_ += weight * (x_[v] * x_[v] - motion_);
  }

  JointFilterEstimate<Scalar> estimate(JointOutcome outcome, Scalar nis) const {
    static_assert(kStates - lambda == JointUnknown::kCount);
    JointBelief<Scalar> belief;
    belief.theta = x_.template tail<JointUnknown::kCount>();
    for (int i = 0; i < JointUnknown::kCount; ++i) {
      for (int j = 0; j < JointUnknown::kCount; ++j) belief.A(i, j) = A_(lambda + i, lambda + j);
    }
    belief.has_failed = has_failed_;
    belief.time_s = time_s_;
    if (time_s_ > Scalar(0)) {
      belief.mean_p_m = sum_p_ / time_s_;
      belief.mean_p2 = sum_p2_ / time_s_;
      belief.mean_u2 = sum_u2_ / time_s_;
      belief.mean_v2 = sum_v2_ / time_s_;
      belief.mean_a2 = sum_a2_ / time_s_;
    }
    JointFilterEstimate<Scalar> estimate = JointConclusion<Scalar>(parameters_, monitor_).draw(belief);
    estimate.outcome = outcome;
    estimate.nis = nis;
    estimate.position_m = x_[p];
    estimate.velocity_m_s = x_[v];
    return estimate;
  }

  JointParameters parameters_;
  State x_ = State::Zero();
  SymmetricMatrix<Scalar, kStates> A_;
  DriveNoiseBias<Scalar> bias_;
  InnovationMoments<Scalar> monitor_;
  bool has_drive_ = false, is_started_ = false, is_lost_ = false, has_failed_ = false;
  Scalar interval_s_ = 0, share_ = 1;  // of the drive's interval, what has passed of it
  Array<Scalar, 2> curvature_ = {};    // of the drive at its begin and end
  int rejected_in_a_row_ = 0, taken_in_a_row_ = 0;  // positions
  Scalar clock_s_ = 0, lost_at_s_ = 0;
  Scalar motion_ = 0;  // mean square of the velocity over about a second
  Scalar time_s_ = 0, sum_p_ = 0, sum_p2_ = 0, sum_u2_ = 0, sum_v2_ = 0, sum_a2_ = 0;
};

}  // namespace condyle
