// SPDX-License-Identifier: Apache-2.0
// Damping and stiffness per mass of a relaxed jaw from the motion of the head, whose acceleration
// drives the jaw with a known force per mass.
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
// Estimate:    that of a point of the known mass 1 with the drive u = -a (point_conclusion.h). Its
//              newtons are N/kg, its kv and ks are lambda and kappa. The jaw's own mass cancels: no
//              mass is found. What the motion itself shows of the mass is 1 / g
//
// The jaw is assumed to be relaxed: a muscle that responds to the motion acts like damping or
// stiffness of the joint. The user states the share s that muscles may add to the inertial
// force -m a (rms, about its mean). The default 1 means unknown, and nothing is measured. s is the
// share that the drive misses. The uncertainties of the gain and of the lever's share are those of
// one scale, sigma_g^2 = gain^2 + lever^2.
#pragma once

#include "condyle/estimator/impedance/point_identification.h"

namespace condyle {

/// Assumptions about a head motion.
struct HeadMotionParameters {
  double gain_sd = 0.01;  ///< relative uncertainty of the accelerometer's calibration
  double lever_sd = 0;    ///< share of the acceleration that the head's turning may add or subtract
  double delay_sd_s = 0.005;   ///< of the accelerometer's delay (s), which is subtracted before
  double muscle_share = 1;     ///< s, 0 to 1
  double longest_gap_s = 0.1;  ///< between accelerations; they are unknown in a longer one
  /// Shown, as assumed, if they are not measured.
  ImpedancePrior damping_rate_per_s{40, 40};
  ImpedancePrior stiffness_per_mass_per_s2{400, 400};
  /// The smallest differences that matter to the user.
  double damping_rate_resolution_per_s = 0.4;
  double stiffness_resolution_fraction = 0.1;
};

/// True if every parameter is in its range.
constexpr bool is_valid(const HeadMotionParameters& parameters) {
  constexpr Range positive{1e-9, 1e6}, share{0, 1};
  const auto fits = [&](const ImpedancePrior& prior) {
    return Range{-1e6, 1e6}.contains(prior.mean) && positive.contains(prior.sd);
  };
  return share.contains(parameters.gain_sd) && share.contains(parameters.lever_sd) &&
         share.contains(parameters.delay_sd_s) && share.contains(parameters.muscle_share) &&
         Range{1e-4, 10}.contains(parameters.longest_gap_s) &&
         fits(parameters.damping_rate_per_s) && fits(parameters.stiffness_per_mass_per_s2) &&
         positive.contains(parameters.damping_rate_resolution_per_s) &&
         positive.contains(parameters.stiffness_resolution_fraction);
}

/// The results. Of the limits, `missing` means that muscles may add too much, and `mass_stated`
/// that the motion shows another gain of the accelerometer.
template <class Scalar>
struct HeadMotionEstimate {
  IdentifiedValue<Scalar> damping_rate_per_s, stiffness_per_mass_per_s2;
  Scalar gain = 1, gain_sd = 0;  ///< g from the motion itself, and its uncertainty; may be infinite
  /// Residual of the model relative to the noise; NaN before the first conclusion, as are the other
  /// values.
  Scalar residual_ratio = std::numeric_limits<Scalar>::quiet_NaN();
  Scalar acceleration_noise_sd_m_s2 = residual_ratio, position_noise_sd_m = residual_ratio;
  Scalar rms_acceleration_m_s2 = residual_ratio;  ///< of a, about its mean
  Scalar rms_position_m = residual_ratio, rms_velocity_m_s = residual_ratio;  ///< of p about, of v
};

/// The identification. Fixed size, no allocation; see above.
template <class Scalar>
class HeadMotionIdentification {
 public:
  /// `parameters` must be valid.
  explicit HeadMotionIdentification(const HeadMotionParameters& parameters)
      : parameters_(parameters), point_(point_of(parameters)) {}

  /// An acceleration of the head (m/s^2) at its true time, in order; no later than the first
  /// position after it.
  void add_acceleration(TimeNs time_ns, Scalar acceleration_m_s2) {
    point_.add_drive(time_ns, -acceleration_m_s2);
  }

  /// A position (m) relative to the head, in order.
  void add_position(TimeNs time_ns, Scalar position_m) { point_.add_position(time_ns, position_m); }

  /// Concludes from everything given so far; otherwise this happens once a second.
  void conclude() { point_.conclude(); }

  /// The last conclusion.
  HeadMotionEstimate<Scalar> estimate() const {
    using std::abs;
    const ImpedanceEstimate<Scalar>& impedance = point_.estimate();
    HeadMotionEstimate<Scalar> estimate;
    estimate.damping_rate_per_s = impedance.friction_Ns_m;
    estimate.stiffness_per_mass_per_s2 = impedance.stiffness_N_m;
    IdentifiedValue<Scalar>& stiffness = estimate.stiffness_per_mass_per_s2;
    const Scalar highest_sd =
        Scalar(parameters_.stiffness_resolution_fraction / 2) * abs(stiffness.fitted);
    if (!is_failure(stiffness.limit) && stiffness.fitted_sd <= highest_sd) {
      stiffness.limit = ImpedanceLimit::none;
      stiffness.quantity = {stiffness.fitted, stiffness.fitted_sd, Provenance::measured};
    }
    estimate.gain = Scalar(1) / impedance.mass_kg.fitted;
    estimate.gain_sd = impedance.mass_kg.fitted_sd * estimate.gain * estimate.gain;
    estimate.residual_ratio = impedance.residual_ratio;
    estimate.acceleration_noise_sd_m_s2 = impedance.drive_noise_sd_N;
    estimate.position_noise_sd_m = impedance.position_noise_sd_m;
    estimate.rms_acceleration_m_s2 = impedance.drive_variation_rms_N;
    estimate.rms_position_m = impedance.position_rms_m;
    estimate.rms_velocity_m_s = impedance.velocity_rms_m_s;
    return estimate;
  }

  DriveCounts counts() const { return point_.counts(); }

 private:
  static ImpedanceParameters point_of(const HeadMotionParameters& parameters) {
    // A resolution so small that it never decides: that of the stiffness is a share of it.
    constexpr double kNever = 1e-9;
    ImpedanceParameters point;
    point.friction_Ns_m = parameters.damping_rate_per_s;
    point.friction_resolution_Ns_m = parameters.damping_rate_resolution_per_s;
    point.mass = MassModel::known;
    point.mass_kg = {1, kNever};
    point.stiffness_N_m = {parameters.stiffness_per_mass_per_s2.mean, kNever};
    point.drive.gain_sd = std::sqrt(parameters.gain_sd * parameters.gain_sd +
                                    parameters.lever_sd * parameters.lever_sd);
    point.drive.delay_sd_s = parameters.delay_sd_s;
    point.drive.missing_share = parameters.muscle_share < 1  // of the total, not of -m a
                                    ? parameters.muscle_share / (1 + parameters.muscle_share)
                                    : 1;
    point.drive.longest_gap_s = parameters.longest_gap_s;
    return point;
  }

  HeadMotionParameters parameters_;
  PointIdentification<Scalar> point_;
};

}  // namespace condyle
