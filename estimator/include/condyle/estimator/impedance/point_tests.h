// SPDX-License-Identifier: Apache-2.0
// The tests that can withhold all values of a recording; the fits are those of point_candidate.h.
//
//   R         the smallest residual of the fits (regression_fit.h)
//   T, w_c    duration, and the frequency up to which the kernel passes
//
// A delay within its statement fails none:
//   noise              R beyond 1.25 + 3 sqrt(2 / (T w_c / 3.55))
//   drive_reversed     m below -3; implausible_mass: m beyond 3 outside the stated range
//   mass_stated        if the mass is known: m of P or E with its column beyond 3 from it
//   dynamics           u'' added to E, beyond 3 standard deviations
//   delay_stated       tau, u' added to E0, beyond 4 from what is stated
//   changing           trends of kv in P0, of m in E or of tau, beyond 3
//   negative_friction  kv below -3
// Known mass: they are by fits with the column of a, which takes up a gain within its statement,
// but for tau; m is theirs.
#pragma once

#include "condyle/estimator/impedance/impedance_estimate.h"
#include "condyle/estimator/impedance/point_candidate.h"

namespace condyle::internal {

/// rms of the motion and of the drive (SI) after the kernel, without their noise.
struct PointMotion {
  double a = 0, v = 0, x = 0, u = 0;
  double u_about_mean = 0;  ///< x is about its mean, too

  template <class Scalar>
  static PointMotion of(const RegressionData<Scalar>& data) {
    using std::sqrt;
    const RegressionSums<double>& sum = data.sum();
    const auto mean2 = [&](RegressionColumn column) {
      return (sum.product(column, column) - data.noise(sum, column, column)) / sum.instants;
    };
    PointMotion rms;
    rms.a = sqrt(mean2(kAccelerationColumn));
    rms.v = sqrt(mean2(kVelocityColumn));
    rms.x = sqrt(mean2(kPositionColumn) -
                 square(sum.product(kPositionColumn, kOneColumn) / sum.instants));
    rms.u = sqrt(mean2(kDriveColumn));
    rms.u_about_mean =
        sqrt(mean2(kDriveColumn) - square(sum.product(kDriveColumn, kOneColumn) / sum.instants));
    return rms;
  }
};

/// What is stated about the drive and about a known mass.
class PointStatement {
 public:
  PointStatement(const ImpedanceParameters& parameters, const PointMotion& motion)
      : drive_(parameters.drive) {
    const bool is_mass_known = parameters.mass == MassModel::known;
    const double measured_N = is_mass_known ? motion.u_about_mean : motion.u;
    missing_N_ = missing_over_measured(drive_.missing_share) * measured_N;
    tested_missing_N_ = drive_.missing_share < 1 ? missing_N_ : measured_N;
    mass_variance_ = is_mass_known ? square(parameters.mass_kg.sd) : 0;
  }

  /// rms of the force that the drive may miss (N); infinite if that is unknown.
  double missing_N() const { return missing_N_; }
  /// The same for a test: what it shows is wrong even if as much is missing as was measured.
  double tested_missing_N() const { return tested_missing_N_; }
  /// Of a known mass (kg^2).
  double mass_variance() const { return mass_variance_; }
  /// Relative variance of the one scale of drive, positions and axis.
  double scale2() const {
    return square(drive_.gain_sd) + square(drive_.position_scale_sd) +
           0.75 * square(square(drive_.axis_angle_sd_rad));
  }

 private:
  const DriveParameters& drive_;
  double missing_N_ = 0, tested_missing_N_ = 0, mass_variance_ = 0;
};

/// The results of the tests.
template <class Scalar>
class PointTests {
 public:
  using Fit = RegressionFit<Scalar>;

  /// `mass` and `friction` as they would be shown; if the mass is known, `mass` as if it were
  /// unknown. `residual`: R so far; may be lowered.
  PointTests(const RegressionData<Scalar>& data, const ImpedanceParameters& parameters,
             const PointMotion& motion, const PointStatement& stated, const Fit& E, const Fit& P0,
             const Candidate& mass, const Candidate& friction, double& residual)
      : parameters_(parameters),
        columns_(parameters),
        motion_(motion),
        stated_(stated),
        mass_(mass),
        friction_(friction) {
    using std::sqrt;
    const Fit late(data, columns_.late());
    residual = late.lower_residual(residual);
    const FittedValue delay = late.fitted(kDriveSlopeColumn);  // relative to the stated delay
    const FittedValue curvature = Fit(data, columns_.curved()).fitted(kDriveCurvatureColumn);
    const double curvature_sd = sqrt(Candidate{curvature}.all2(columns_.delay_sd_s()));
    curvature_s4_ = curvature.is_known() ? square(curvature.value) + square(curvature_sd)
                                         : FittedValue::kUnbounded;
    const double independent = data.duration_s() * data.setup().cutoff_rad_s / 3.55;
    failure_ = of_mass();
    if (failure_ != ImpedanceLimit::none) return;
    if (residual < FittedValue::kUnbounded && residual > 1.25 + 3 * sqrt(2 / independent)) {
      failure_ = ImpedanceLimit::noise;
    } else if (curvature.is_known() && beyond(curvature.value, kDynamics * curvature_sd)) {
      failure_ = ImpedanceLimit::dynamics;
    } else if (delay.is_known() && beyond(delay.value, kDelay * sd_of_delay(delay))) {
      failure_ = ImpedanceLimit::delay_stated;
    } else if (!has_walk(parameters_) &&
               (has_trend(P0.fitted(kVelocityColumn)) || has_trend(E.fitted(kAccelerationColumn)) ||
                has_trend(delay))) {
      failure_ = ImpedanceLimit::changing;
    } else if (friction_.fit.is_known() && friction_.fit.value < -kNegative * sd_of_friction()) {
      failure_ = ImpedanceLimit::negative_friction;
    }
  }

  ImpedanceLimit failure() const { return failure_; }
  /// The part of u'' that the test of dynamics leaves open, squared (s^4).
  double curvature_s4() const { return curvature_s4_; }

 private:
  static constexpr double kDynamics = 3, kDelay = 4, kTrend = 3, kNegative = 3, kMassStated = 3;

  static bool beyond(double value, double limit) {
    using std::abs;
    return abs(value) > limit;
  }

  ImpedanceLimit of_mass() const {
    using std::sqrt;
    if (!mass_.fit.is_known()) return ImpedanceLimit::none;
    const double mass = mass_.fit.value,
                 mass_sd =
                     sqrt(mass_.all2(columns_.delay_sd_s()) + stated_.scale2() * square(mass) +
                          square(stated_.tested_missing_N() / motion_.a) + stated_.mass_variance());
    if (columns_.is_mass_known()) {
      return beyond(mass - parameters_.mass_kg.mean, kMassStated * mass_sd)
                 ? ImpedanceLimit::mass_stated
                 : ImpedanceLimit::none;
    }
    if (mass < -kNegative * mass_sd) return ImpedanceLimit::drive_reversed;
    return mass + kNegative * mass_sd < parameters_.least_mass_kg ||
                   mass - kNegative * mass_sd > parameters_.most_mass_kg
               ? ImpedanceLimit::implausible_mass
               : ImpedanceLimit::none;
  }

  double sd_of_delay(const FittedValue& delay) const {
    using std::sqrt;
    return sqrt(square(delay.sd) + square(delay.correction) + square(parameters_.drive.delay_sd_s) +
                stated_.scale2() *
                    square(delay.value - parameters_.mass_kg.mean * delay.per_known_mass));
  }
  double sd_of_friction() const {
    using std::sqrt;
    return sqrt(friction_.all2(columns_.delay_sd_s()) +
                square(stated_.tested_missing_N() / motion_.v));
  }

  // A delay within its statement is not a trend.
  bool has_trend(const FittedValue& fit) const {
    return fit.is_known() &&
           square(fit.trend) >
               square(kTrend) * (fit.trend2 + square(columns_.delay_sd_s() * fit.trend_per_delay));
  }

  const ImpedanceParameters& parameters_;
  PointColumns columns_;
  const PointMotion& motion_;
  const PointStatement& stated_;
  const Candidate &mass_, &friction_;
  double curvature_s4_ = 0;
  ImpedanceLimit failure_ = ImpedanceLimit::none;
};

}  // namespace condyle::internal
