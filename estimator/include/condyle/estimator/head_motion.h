// SPDX-License-Identifier: Apache-2.0
// Damping and stiffness per mass of a relaxed jaw, from the motion of the head: what accelerates
// the head drives the jaw in it, by a known force per mass.
//
//   z, a      measured position of the jaw relative to the head (m); reading along the same axis of
//             an accelerometer on the facebow (m/s^2), gravity included
//   p, v      position (m), velocity (m/s) relative to the head
//   lambda, kappa   kv / m (1/s), ks / m (1/s^2)
//   g         true over measured acceleration, about 1
//   c         constant acceleration: weight, rest position, the accelerometer's zero (m/s^2)
//
// Model:       p' = v,   v' = -g a + c - lambda v - kappa p
//              An accelerometer feels weight as the jaw does, so that a head that tilts is no
//              error. One that turns is: at a lever r from the jaw a lacks r times the angular
//              acceleration
// Filter:      joint_identification.h with the drive u = -a. Its newtons are N/kg, its m is 1/g,
// its
//              kv and ks are lambda / g and kappa / g; its prior of m is what is known of g. The
//              jaw's own mass cancels: no mass is ever told
// Estimate:    lambda and kappa themselves, with the filter's variances: an error of g has been
//              estimated along, with the motion and the calibration
//
// A relaxed jaw is presumed: a muscle that answers to the motion is damping, or stiffness, that
// nobody can tell from the joint's. The user states the share s that muscles may add to the
// inertial force -m a (rms, about its mean); 1, the default, is: nobody knows, and nothing is
// measured. It widens the intervals, and so does the uncertainty sigma_t of a's delay:
//   muscles   in phase with a: sigma_g^2 + s^2 is the variance of g
//             in phase with v, p: s rms(a) / rms(v) for lambda, s rms(a) / rms(p) for kappa
//   delay     sigma_t a' = v dlambda + p dkappa + a dg, by least squares: dg is what it would be
//             with g free times the share of g's variance that the motion has taken
// At one frequency alone a, v and p are linearly dependent: then the calibration of g is all that
// tells kappa.
#pragma once

#include "condyle/estimator/joint_identification.h"

namespace condyle {

/// What is taken for granted of a head motion.
struct HeadMotionParameters {
  double acceleration_noise_sd_m_s2 = 0.05;  ///< white, of each sample
  double gain_sd = 0.01;                     ///< sigma_g
  double delay_sd_s = 0.005;                 ///< sigma_t (s); the delay itself is taken off before
  double muscle_share = 1;                   ///< s, 0 to 1
  /// How much subjects differ, before any measurement.
  JointPrior damping_rate_per_s{40, 40};
  JointPrior stiffness_per_mass_per_s2{400, 400};
  double offset_sd_m_s2 = 20;  ///< of c, mean 0
  /// The smallest differences that matter to the user.
  double damping_rate_resolution_per_s = 0.4;
  double stiffness_resolution_fraction = 0.1;
};

/// True where every parameter can be used.
constexpr bool is_valid(const HeadMotionParameters& parameters) {
  constexpr Range positive{1e-9, 1e6};
  const auto fits = [&](const JointPrior& prior) {
    return Range{-1e6, 1e6}.contains(prior.mean) && positive.contains(prior.sd);
  };
  return positive.contains(parameters.acceleration_noise_sd_m_s2) &&
         Range{1e-6, 1}.contains(parameters.gain_sd) &&
         Range{0, 1}.contains(parameters.delay_sd_s) &&
         Range{0, 1}.contains(parameters.muscle_share) && fits(parameters.damping_rate_per_s) &&
         fits(parameters.stiffness_per_mass_per_s2) &&
         positive.contains(parameters.offset_sd_m_s2) &&
         positive.contains(parameters.damping_rate_resolution_per_s) &&
         positive.contains(parameters.stiffness_resolution_fraction);
}

/// What is known after a sample. Of the limits, `missing` is that muscles may add too much.
template <class Scalar>
struct HeadMotionEstimate {
  IdentifiedValue<Scalar> damping_rate_per_s, stiffness_per_mass_per_s2;
  Scalar gain = 1, gain_sd = 0;  ///< g, and what the filter makes of its uncertainty
  Scalar mean_nis = 0, innovation_correlation = 0;  ///< 1 and 0 where the model holds
  Scalar rms_acceleration_m_s2 = 0;                 ///< of a, about its mean
  Scalar rms_position_m = 0, rms_velocity_m_s = 0;  ///< of p about its mean, and v
};

/// The filter. Fixed size, no allocation; see above.
template <class Scalar>
class HeadMotionIdentification {
 public:
  /// `parameters` must be valid.
  explicit HeadMotionIdentification(const HeadMotionParameters& parameters)
      : parameters_(parameters), stage_(joint_of(parameters)) {}

  /// The head's acceleration is to go from where it is to `a` (m/s^2), measured `T` s later; as
  /// JointIdentification::drive.
  void accelerate(Scalar T, Scalar a) {
    before_m_s2_ = has_acceleration_ ? now_m_s2_ : a;
    now_m_s2_ = a;
    T_s_ = has_acceleration_ ? T : Scalar(0);
    has_acceleration_ = true;
    stage_.drive(T, -a);
  }

  /// A position `z` (m) relative to the head, as JointIdentification::measure.
  void measure(Scalar share, Scalar z, Scalar sd) {
    const JointFilterEstimate<Scalar> joint = stage_.measure(share, z, sd);
    if (joint.outcome != JointOutcome::updated) return;
    const Vector4 now(joint.velocity_m_s, joint.position_m,
                      before_m_s2_ + share * (now_m_s2_ - before_m_s2_),
                      T_s_ > Scalar(0) ? (now_m_s2_ - before_m_s2_) / T_s_ : Scalar(0));
    count_ += Scalar(1);
    sum_ += now;
    squares_ += now * now.transpose();
    // What the accelerometer's noise adds to a^2 and a a'.
    const Scalar variance = square(Scalar(parameters_.acceleration_noise_sd_m_s2));
    const Scalar rest = Scalar(1) - share;
    squares_(kA, kA) -= variance * (share * share + rest * rest);
    if (T_s_ > Scalar(0)) squares_(kA, kRate) -= variance * (share - rest) / T_s_;
  }

  /// Forgets where the jaw is and what drives it, not what is known of it: after a gap.
  void interrupt() {
    stage_.interrupt();
    has_acceleration_ = false;
  }

  /// What is known now.
  HeadMotionEstimate<Scalar> estimate() const {
    using std::abs;
    using std::sqrt;
    const JointFilterEstimate<Scalar> joint = stage_.estimate();
    const auto& A = stage_.covariance();
    HeadMotionEstimate<Scalar> estimate;
    estimate.gain = Scalar(1) / joint.mass_kg.fitted;
    estimate.gain_sd = sqrt(A(kEta, kEta));
    estimate.mean_nis = joint.mean_nis;
    estimate.innovation_correlation = joint.innovation_correlation;
    IdentifiedValue<Scalar>& damping = estimate.damping_rate_per_s;
    IdentifiedValue<Scalar>& stiffness = estimate.stiffness_per_mass_per_s2;
    damping = identified(joint.friction_Ns_m, estimate.gain, A(kLambda, kLambda),
                         parameters_.damping_rate_per_s);
    stiffness = identified(joint.stiffness_N_m, estimate.gain, A(kKappa, kKappa),
                           parameters_.stiffness_per_mass_per_s2);
    Vector2 muscles = Vector2::Zero(), delays = Vector2::Zero();
    if (count_ > Scalar(0)) {
      const Vector4 mean = sum_ / count_;
      const Matrix4 C = squares_ / count_ - mean * mean.transpose();
      estimate.rms_acceleration_m_s2 = root(C(kA, kA));
      estimate.rms_position_m = root(C(kP, kP));
      estimate.rms_velocity_m_s = root(squares_(kV, kV) / count_);
      const Scalar force = Scalar(parameters_.muscle_share) * estimate.rms_acceleration_m_s2;
      muscles = Vector2(force / estimate.rms_velocity_m_s, force / estimate.rms_position_m);
      const Scalar taken = Scalar(1) - A(kEta, kEta) / square(Scalar(gain_prior_sd(parameters_)));
      delays = Scalar(parameters_.delay_sd_s) * of_delay(C, taken).cwiseAbs();
    }
    conclude(damping, joint.mass_kg.limit, muscles[0], delays[0],
             Scalar(parameters_.damping_rate_resolution_per_s));
    conclude(stiffness, joint.mass_kg.limit, muscles[1], delays[1],
             Scalar(parameters_.stiffness_resolution_fraction) * abs(stiffness.fitted));
    return estimate;
  }

 private:
  using Vector2 = Eigen::Matrix<Scalar, 2, 1>;
  using Vector4 = Eigen::Matrix<Scalar, 4, 1>;
  using Matrix4 = Eigen::Matrix<Scalar, 4, 4>;
  enum { kV, kP, kA, kRate };  // of the moments
  // Places in the stage's covariance.
  static constexpr int kTheta = 4;  // where theta begins
  static constexpr int kLambda = kTheta + JointUnknown::kLambda, kEta = kTheta + JointUnknown::kEta;
  static constexpr int kKappa = kTheta + JointUnknown::kKappa;

  static Scalar square(Scalar value) { return value * value; }

  static double gain_prior_sd(const HeadMotionParameters& parameters) {
    return std::sqrt(parameters.gain_sd * parameters.gain_sd +
                     parameters.muscle_share * parameters.muscle_share);
  }

  static JointParameters joint_of(const HeadMotionParameters& parameters) {
    JointParameters joint;
    joint.friction_Ns_m = parameters.damping_rate_per_s;
    joint.mass_kg = {1, gain_prior_sd(parameters)};
    joint.stiffness_N_m = parameters.stiffness_per_mass_per_s2;
    joint.offset_N = {0, parameters.offset_sd_m_s2};
    joint.drive.noise_sd_N = parameters.acceleration_noise_sd_m_s2;
    joint.drive.gain_sd = 0;
    joint.drive.delay_sd_s = 0;
    joint.drive.missing_share = 0;
    return joint;
  }

  static Scalar root(Scalar variance) {
    using std::sqrt;
    return variance > Scalar(0) ? sqrt(variance) : Scalar(0);
  }

  // dlambda and dkappa of a delay of 1 s, from the moments of (v, p, a, a'); `taken`: of g's
  // variance.
  static Vector2 of_delay(const Matrix4& C, Scalar taken) {
    const Scalar determinant = C(kV, kV) * C(kP, kP) - C(kV, kP) * C(kV, kP);
    if (!(determinant > Scalar(0))) return Vector2::Zero();
    const auto on_v_p = [&](int column) {
      return Vector2((C(kP, kP) * C(kV, column) - C(kV, kP) * C(kP, column)) / determinant,
                     (C(kV, kV) * C(kP, column) - C(kV, kP) * C(kV, column)) / determinant);
    };
    const Vector2 of_a = on_v_p(kA), of_rate = on_v_p(kRate);
    const Scalar own = C(kA, kA) - of_a[0] * C(kV, kA) - of_a[1] * C(kP, kA);
    const Scalar shared = C(kA, kRate) - of_a[0] * C(kV, kRate) - of_a[1] * C(kP, kRate);
    const Scalar of_gain = own > Scalar(0) ? taken * shared / own : Scalar(0);
    return of_rate - of_gain * of_a;
  }

  // `per_gain`: the stage's value, that over g.
  static IdentifiedValue<Scalar> identified(const IdentifiedValue<Scalar>& per_gain, Scalar gain,
                                            Scalar filter_variance, const JointPrior& prior) {
    using std::sqrt;
    IdentifiedValue<Scalar> identified;
    identified.quantity = {Scalar(prior.mean), Scalar(prior.sd), Provenance::assumed};
    identified.fitted = per_gain.fitted * gain;
    identified.sampling_sd = sqrt(filter_variance > Scalar(0) ? filter_variance : Scalar(0));
    identified.information = information_share(filter_variance, square(Scalar(prior.sd)));
    return identified;
  }

  // `checks`: the stage's limit of a value that nothing else limits.
  static void conclude(IdentifiedValue<Scalar>& value, JointLimit checks, Scalar muscles,
                       Scalar delay, Scalar resolution) {
    using std::sqrt;
    const Scalar filter = value.sampling_sd;
    value.fitted_sd = sqrt(square(filter) + square(muscles) + square(delay));
    if (checks == JointLimit::no_drive || checks == JointLimit::too_early ||
        checks == JointLimit::model) {
      value.limit = checks;
    } else if (!(value.information >= Scalar(kMeasuredInformationShare))) {
      value.limit = JointLimit::information;
    } else if (!(value.fitted_sd <= resolution / Scalar(2))) {
      value.limit = muscles >= filter && muscles >= delay ? JointLimit::missing
                    : delay >= filter                     ? JointLimit::delay
                                                          : JointLimit::resolution;
    } else {
      value.limit = JointLimit::none;
      value.quantity = {value.fitted, value.fitted_sd, Provenance::measured};
    }
  }

  HeadMotionParameters parameters_;
  JointIdentification<Scalar> stage_;
  bool has_acceleration_ = false;
  Scalar before_m_s2_ = 0, now_m_s2_ = 0, T_s_ = 0;  // of a, over the present interval
  // Of the positions that were taken: sums of (v, p, a, a') and of their products.
  Scalar count_ = 0;
  Vector4 sum_ = Vector4::Zero();
  Matrix4 squares_ = Matrix4::Zero();
};

}  // namespace condyle
