// SPDX-License-Identifier: Apache-2.0
// The effective damping of single chewing cycles of a point whose total drive is known. Each cycle
// uses only its own samples, so that a change can be seen.
//
//   z, u      measured position (m) and drive (N) of a sample
//   theta     lambda, eta, kappa, c (mass_spring_damper.h), at the baseline, which is not updated
//   y, P, K   state (p, v, u) of the linear filter at theta, its covariance and gain; H = (1 0 0)
//   r, S      innovation z - H y and its variance H P H' + R
//   W, psi    dy / dtheta; psi = H W before the update, so that r = psi dtheta + noise
//   k         kv, m, ks, b: kv = lambda / eta and so on (point_regression.h); G = dtheta / dk
//   s, I      score and information of dk over a cycle
//
// Prediction:  y, P by mass_spring_damper.h and drive_noise_bias.h, W <- F W + the step's
// derivatives Update:      s += G' (psi' r / S + r^2 / S times what drive_noise_bias.h adds)
//              I += G' psi' psi G / S
//              y <- y + K r, W <- W - K psi
// Cycle end:   dk = I^-1 s with all four unknown: what an error of m, ks and b leaves in a single
//              cycle is taken out (over a whole one a, p and 1 are nearly orthogonal to v, so that
//              this costs little); kv of the cycle is the baseline's + dk_kv, its variance
//              (I^-1)_kv,kv; s = I = 0; W, which forgets in some 0.1 s, goes on
//
// One scoring step from the baseline (Fisher scoring): innovations are white, so that cycles are as
// good as independent. It is exact to first order: far off the baseline the value is too near it,
// by about dk_kv^2 tau / m with tau = (sum W_v,lambda^2 / sum v^2)^1/2, over how long the filter
// follows its model rather than the positions. This is added to the standard deviation. Farther off
// the positions lie beyond the gate, no cycle counts and the outcome is `lost`.
//
// Errors of the assumptions about the drive (point_judgement.h) shift each cycle's damping too. If
// they are the same in all cycles, a change is still a change. A drive that is late by tau is an
// exception: it adds m w^2 tau, which follows the rhythm w.
#pragma once

#include "condyle/estimator/changes/change_parameters.h"
#include "condyle/estimator/changes/cycle_segmentation.h"
#include "condyle/estimator/impedance/drive_noise_bias.h"
#include "condyle/estimator/impedance/impedance_estimate.h"
#include "condyle/estimator/impedance/impedance_parameters.h"
#include "condyle/estimator/impedance/mass_spring_damper.h"

namespace condyle {

/// Effect of a sample on the cycles.
enum class CycleOutcome : std::uint8_t {
  none,        ///< no cycle ended
  counted,     ///< a cycle ended, and its damping is known with the stated uncertainty
  irregular,   ///< a cycle ended that was too short or too long
  incomplete,  ///< a cycle ended with too many positions missing or beyond the gate
  uncertain,   ///< a cycle ended with too little information
  lost,        ///< ten positions in a row were beyond the gate: the point slipped, or is no longer
               ///< what the baseline says; if the next cycles end so too, identify it anew
};

/// Name of an outcome in files and summaries.
constexpr const char* cycle_outcome_name(CycleOutcome outcome) {
  constexpr const char* names[] = {"", "counted", "irregular", "incomplete", "uncertain", "lost"};
  return names[static_cast<int>(outcome)];
}

/// A cycle that ended.
template <class Scalar>
struct CycleReport {
  CycleOutcome outcome = CycleOutcome::none;
  Scalar friction_Ns_m = std::numeric_limits<Scalar>::quiet_NaN();       ///< if counted
  Scalar standard_deviation = std::numeric_limits<Scalar>::quiet_NaN();  ///< if counted (Ns/m)
  Scalar duration_s = 0;
  /// If counted: rms of the drive and of the acceleration over that of the velocity. A force
  /// missing from the drive, or its delay, shifts the damping by its share of these.
  Scalar drive_per_velocity_Ns_m = std::numeric_limits<Scalar>::quiet_NaN();
  Scalar rhythm_rad_s = std::numeric_limits<Scalar>::quiet_NaN();  ///< w
};

/// The baseline from an identification that ran over it.
template <class Scalar>
DampingBaseline baseline_of(const ImpedanceEstimate<Scalar>& estimate) {
  return {static_cast<double>(estimate.plain.friction_Ns_m),
          static_cast<double>(estimate.plain.mass_kg),
          static_cast<double>(estimate.plain.stiffness_N_m),
          static_cast<double>(estimate.plain.offset_N)};
}

/// Estimates each cycle's damping. Fixed size, no allocation; see above.
template <class Scalar>
class CycleDamping {
 public:
  /// All must be valid. Only the noises and the gate of `impedance` are used.
  CycleDamping(const DampingBaseline& baseline, const ImpedanceParameters& impedance,
               const CycleParameters& parameters)
      : parameters_(parameters),
        friction_Ns_m_(Scalar(baseline.friction_Ns_m)),
        velocity_variance_(square(Scalar(impedance.velocity_sd_m_s))),
        drive_variance_(square(Scalar(impedance.drive.noise_sd_N))),
        gate_(square(Scalar(impedance.gate_sd))),
        cutter_(Scalar(parameters.travel_m)) {
    const Scalar e = Scalar(1) / Scalar(baseline.mass_kg);
    rates_ = {friction_Ns_m_ * e, e, Scalar(baseline.stiffness_N_m) * e,
              Scalar(baseline.offset_N) * e};
    force_density_ = square(Scalar(impedance.force_noise_N_root_s) * e);
  }

  /// The next sample, `T` s after the previous one: its drive `u` (N) and its position `z` (m) with
  /// noise of standard deviation `sd` (m); NaN if there is no position. A drive that is not finite,
  /// or a time that does not advance, is an interruption.
  CycleReport<Scalar> step(Scalar T, Scalar u, Scalar z, Scalar sd) {
    if (!is_finite(u)) {
      interrupt();
      return {};
    }
    if (!(T > Scalar(0) && T <= Scalar(parameters_.longest_gap_s))) interrupt();
    if (!is_started_) {
      if (is_finite(z)) start(u, z, square(sd));
      return {};
    }
    predict(T, u);
    ++samples_;
    if (is_finite(z) && !update(z, square(sd))) {
      interrupt();
      CycleReport<Scalar> report;
      report.outcome = CycleOutcome::lost;
      return report;
    }
    return cut();
  }

  /// The drive `u` (N), `T` s after the previous input, at an instant at which no position was due.
  void drive(Scalar T, Scalar u) {
    if (!is_finite(u) || !(T > Scalar(0) && T <= Scalar(parameters_.longest_gap_s))) {
      interrupt();
    } else if (is_started_) {
      predict(T, u);
    }
  }

  /// Drops the cycle and forgets the place of the point: after a contact, or a gap without drive.
  void interrupt() {
    is_started_ = false;
    cutter_.reset();
    clear_cycle();
  }

 private:
  enum { p, v, u_, kDriveNow };  // in y; the drive at the last sample is y's third, P's fourth
  enum { kMass, kStiffness, kOffset, kFriction, kUnknowns };  // in k; friction is eliminated last
  using Matrix4 = Eigen::Matrix<Scalar, kUnknowns, kUnknowns>;
  using Vector4 = Eigen::Matrix<Scalar, kUnknowns, 1>;

  static Scalar square(Scalar value) { return value * value; }
  static bool is_finite(Scalar value) { return value - value == Scalar(0); }

  void start(Scalar u, Scalar z, Scalar R) {
    y_ << z, Scalar(0), u;
    W_.setZero();
    bias_.drive(drive_variance_);
    bias_.start(R, velocity_variance_);
    rejected_in_a_row_ = 0;
    is_started_ = true;
  }

  void predict(Scalar T, Scalar u) {
    duration_s_ += T;
    if (T != response_s_) {
      response_ = driven_response(rates_, T);
      response_s_ = T;
    }
    const DrivenStep<Scalar> step = driven_step(rates_, response_, y_[p], y_[v], y_[u_], u);
    const auto row = [this](const typename DrivenStep<Scalar>::Row& of) {
      return Eigen::Matrix<Scalar, 1, 4>(of[kOfPosition] * W_.row(p) + of[kOfVelocity] * W_.row(v) +
                                         of[kOfDriveBefore] * W_.row(u_) +
                                         of.template segment<4>(kOfLambda).matrix());
    };
    const Eigen::Matrix<Scalar, 1, 4> of_p = row(step.position), of_v = row(step.velocity);
    W_.row(p) = of_p;
    W_.row(v) = of_v;
    W_.row(u_).setZero();
    y_ << step.position[kSolution], step.velocity[kSolution], u;
    bias_.drive(drive_variance_);
    bias_.predict(rates_, response_, Scalar(0), Scalar(1), T, force_density_, T);
  }

  // False if the filter has lost the point.
  bool update(Scalar z, Scalar R) {
    constexpr int kMostInARow = 10;
    const SymmetricMatrix<Scalar, 4>& P = bias_.covariance();
    const Scalar S = P(p, p) + R, r = z - y_[p], nis = r * r / S;
    if (!(nis <= gate_)) return ++rejected_in_a_row_ < kMostInARow && is_finite(nis);
    rejected_in_a_row_ = 0;
    ++taken_;
    const Vector3<Scalar> K(P(p, p) / S, P(p, v) / S, P(p, kDriveNow) / S);
    const Eigen::Matrix<Scalar, 1, 4> psi = W_.row(p);
    score_ += psi.transpose() * (r / S);
    score_.template head<3>() += nis * bias_.update(R).template head<3>();
    information_ += psi.transpose() * psi / S;
    y_ += K * r;
    W_ -= K * psi;
    memory_m2_ += square(W_(v, 0));
    velocity_m2_s2_ += square(y_[v]);
    drive_N2_ += square(y_[u_]);
    acceleration_m2_s4_ +=
        square(rates_.eta * y_[u_] + rates_.c - rates_.lambda * y_[v] - rates_.kappa * y_[p]);
    return true;
  }

  CycleReport<Scalar> cut() {
    const CyclePlace place = cutter_.add(y_[p], y_[v]);
    CycleReport<Scalar> report;
    if (place == CyclePlace::end) report = conclude();
    if (place != CyclePlace::within) clear_cycle();
    return report;
  }

  CycleReport<Scalar> conclude() const {
    using std::sqrt;
    CycleReport<Scalar> report;
    report.duration_s = duration_s_;
    if (!(duration_s_ >= Scalar(parameters_.shortest_s) &&
          duration_s_ <= Scalar(parameters_.longest_s))) {
      report.outcome = CycleOutcome::irregular;
    } else if (Scalar(samples_ - taken_) > Scalar(parameters_.share_not_taken) * Scalar(samples_)) {
      report.outcome = CycleOutcome::incomplete;
    } else {
      report.outcome = CycleOutcome::uncertain;
      const Matrix4 G = of_unknowns();
      Matrix4 I = G.transpose() * information_ * G;
      Vector4 s = G.transpose() * score_;
      const Scalar least = Scalar(1) / square(Scalar(parameters_.largest_sd_Ns_m));
      if (eliminate(I, s) && I(kFriction, kFriction) >= least) {
        report.outcome = CycleOutcome::counted;
        const Scalar change = s[kFriction] / I(kFriction, kFriction);
        const Scalar tau = sqrt(memory_m2_ / velocity_m2_s2_);
        report.friction_Ns_m = friction_Ns_m_ + change;
        report.drive_per_velocity_Ns_m = sqrt(drive_N2_ / velocity_m2_s2_);
        report.rhythm_rad_s = sqrt(acceleration_m2_s4_ / velocity_m2_s2_);
        report.standard_deviation =
            sqrt(Scalar(1) / I(kFriction, kFriction) + square(change * change * tau * rates_.eta));
      }
    }
    return report;
  }

  // dtheta / dk.
  Matrix4 of_unknowns() const {
    const Scalar e = rates_.eta;
    Matrix4 G = Matrix4::Zero();
    G.col(kMass) << -rates_.lambda * e, -e * e, -rates_.kappa * e, -rates_.c * e;
    G(2, kStiffness) = G(3, kOffset) = G(0, kFriction) = e;
    return G;
  }

  // Eliminates the first three unknowns from information and score; false if they cannot be
  // separated, or if the result is not finite.
  static bool eliminate(Matrix4& I, Vector4& s) {
    const Scalar rounding = Scalar(100) * std::numeric_limits<Scalar>::epsilon();
    const Vector4 before = I.diagonal();
    for (int i = 0; i < kFriction; ++i) {
      if (!(I(i, i) > rounding * before[i])) return false;
      for (int j = i + 1; j < kUnknowns; ++j) {
        const Scalar share = I(j, i) / I(i, i);
        I.row(j) -= share * I.row(i);
        s[j] -= share * s[i];
      }
    }
    return I(kFriction, kFriction) > rounding * before[kFriction] && is_finite(s[kFriction]);
  }

  void clear_cycle() {
    score_.setZero();
    information_.setZero();
    duration_s_ = memory_m2_ = velocity_m2_s2_ = drive_N2_ = acceleration_m2_s4_ = 0;
    samples_ = taken_ = 0;
  }

  CycleParameters parameters_;
  DrivenRates<Scalar> rates_;
  Scalar friction_Ns_m_, velocity_variance_, drive_variance_, gate_;
  Scalar force_density_ = 0;  ///< of white acceleration (m^2/s^3)
  CycleSegmentation<Scalar> cutter_;

  bool is_started_ = false;
  int rejected_in_a_row_ = 0;
  Vector3<Scalar> y_ = Vector3<Scalar>::Zero();
  Eigen::Matrix<Scalar, 3, 4> W_ = Eigen::Matrix<Scalar, 3, 4>::Zero();
  DriveNoiseBias<Scalar> bias_;
  DrivenResponse<Scalar> response_;  ///< to a step of response_s_
  Scalar response_s_ = 0;

  Vector4 score_ = Vector4::Zero();  ///< of theta, in this cycle, like the following
  Matrix4 information_ = Matrix4::Zero();
  Scalar duration_s_ = 0;
  Scalar memory_m2_ = 0, velocity_m2_s2_ = 0;     ///< sums for tau
  Scalar drive_N2_ = 0, acceleration_m2_s4_ = 0;  ///< sums
  int samples_ = 0, taken_ = 0;
};

}  // namespace condyle
