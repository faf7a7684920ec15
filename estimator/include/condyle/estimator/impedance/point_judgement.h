// SPDX-License-Identifier: Apache-2.0
// What some blocks of a recording say of the point.
//
//   P, P0     the plain fit of m, kv, ks, c (and tau, where the delay is fitted): noise taken out
//             of all columns, or kept in the even ones (regression_fit.h)
//   S         P0 with X^2, X^3, X^4 beside: a spring of any shape. Where the delay is fitted, P
//   with
//             these: u' is odd as v is, yet a motion that differs from itself played backwards
//             couples it with X^k, whose noise may then not be kept
//   E, E0     P, P0 with X^2, X^3, X^4 and the sign of the velocity: also sliding friction
//   V         variance of a value by the scatter of the blocks
//   Fc, f     Fc of E0; f = Fc sum q_s v / sum v^2: sliding friction as damping of the same energy
//
// Candidates: each value has some, with a discrepancy d that another fit tells. The one with the
// smallest sum of V, d^2 and the delay's part is taken:
//   mass      P: d = m_E - m_P.  E: d = (m_P - m_E) / 2
//   friction  P0: d = kv_S - kv_P.  S: d = 0. Either with 0.1 f and the correction for noise, and
//             with half of kv_E + f - kv where the delay is fitted. Where Coulomb friction is
//             fitted, E0 alone: kv is then the viscous part
//   others    stiffness and offset P: d to E. Coulomb friction E0. Delay P: d is half of that to E;
//             E where Coulomb friction is fitted
// Known mass: a has no column, and these are fitted to u - m_0 a. The tests below are by fits with
// the column, which takes up a gain within its statement, but for tau; m is theirs.
// Granted, each apart from the others:
//   gain      sigma_g (theta - m_0 dtheta/dm_0), one scale of all: sigma_g^2 = gain^2 + scale^2 +
//             3/4 angle^4 (a force at an angle A counts with cos A, which is 1 - A^2 / 2)
//   delay     known to s: s times what a second of delay adds, to second order; by regression
//   missing   a force of at most the share s of the total, in phase with v or a: s rms(u) / rms(v);
//             where the mass is known, u about its mean
//   mass      sigma_m dtheta/dm_0
//   smoothing where the noise of the positions is not white, what a square second of u''
//             adds, times what the test of dynamics leaves open: the root of u''^2 + V
//   noise     (0.1 + |R - 1|) times the correction for noise, 0.25 where it is not white; R is the
//             smallest residual of the fits
// A test that fails withholds all values. A delay within its statement fails none:
//   noise              R beyond 1.25 + 3 sqrt(2 / (T w_c / 3.55))
//   drive_reversed     m below -3; implausible_mass: m beyond 3 outside the stated range
//   mass_stated        where the mass is known: m of P or E with its column beyond 3 from it
//   dynamics           u'' added to E, beyond 3 standard deviations
//   delay_stated       tau, u' added to E0, beyond 4 from what is stated
//   changing           trends of kv in P0, of m in E or of tau, beyond 3
//   negative_friction  kv below -3
// Measured: standard deviation, all of it, at most half the resolution that the user asks for.
#pragma once

#include "condyle/estimator/impedance/joint_estimate.h"
#include "condyle/estimator/impedance/point_candidate.h"

namespace condyle {

namespace internal {

/// What the blocks from one on say. Fixed size, no allocation; some 10 kB of stack.
template <class Scalar>
class PointJudgement {
 public:
  PointJudgement(const RegressionBlocks<Scalar>& blocks, const RegressionSetup& setup,
                 const JointParameters& parameters, std::size_t first)
      : parameters_(parameters),
        data_(blocks, setup, first),
        fits_delay_(parameters.delay == DelayModel::fitted),
        delay_sd_s_(fits_delay_ ? 0 : parameters.drive.delay_sd_s),
        is_noise_white_(!data_.has_coloured_positions()) {
    judge();
  }

  void write(JointEstimate<Scalar>& estimate) const {
    using std::sqrt;
    estimate.used_s = Scalar(data_.duration_s());
    estimate.drive_noise_sd_N = Scalar(sqrt(data_.drive_variance_N2()));
    estimate.position_noise_sd_m = Scalar(sqrt(data_.position_variance_m2()));
    estimate.residual_ratio = Scalar(residual_);
    estimate.plain = plain_;
    estimate.drive_rms_N = Scalar(rms_u_);
    estimate.drive_variation_rms_N = Scalar(rms_u_about_mean_);
    estimate.velocity_rms_m_s = Scalar(rms_v_);
    estimate.position_rms_m = Scalar(rms_x_);
    write(mass_, parameters_.mass_kg, parameters_.mass_resolution_fraction * mass_.fit.value,
          1 / rms_a_, estimate.mass_kg);
    write(friction_, parameters_.friction_Ns_m, parameters_.friction_resolution_Ns_m, 1 / rms_v_,
          estimate.friction_Ns_m);
    const auto by_prior = [](const JointPrior& prior) { return sqrt(2.0) * prior.sd; };
    write(stiffness_, parameters_.stiffness_N_m, by_prior(parameters_.stiffness_N_m), 1 / rms_x_,
          estimate.stiffness_N_m);
    write(offset_, parameters_.offset_N, by_prior(parameters_.offset_N), 1, estimate.offset_N);
    if (parameters_.coulomb_N.sd > 0) {
      write(coulomb_, parameters_.coulomb_N, by_prior(parameters_.coulomb_N), 1,
            estimate.coulomb_N);
    }
    if (!fits_delay_) return;
    const JointPrior stated{parameters_.drive.delay_s, parameters_.drive.delay_sd_s, 0};
    write(delay_, stated, by_prior(stated), 0, estimate.delay_s);
  }

 private:
  using Fit = RegressionFit<Scalar>;

  FitColumns columns(bool has_powers, bool has_sign, bool keeps_even_noise) const {
    return columns(parameters_.mass, has_powers, has_sign, keeps_even_noise);
  }
  FitColumns columns(MassModel mass, bool has_powers, bool has_sign, bool keeps_even_noise) const {
    FitColumns columns;
    if (mass == MassModel::fitted) {
      columns.add(kAccelerationColumn);
    } else {
      columns.known_mass_kg = parameters_.mass_kg.mean;
    }
    for (const RegressionColumn column : {kVelocityColumn, kPositionColumn, kOneColumn}) {
      columns.add(column);
    }
    if (has_powers) {
      for (const RegressionColumn column : {kSquareColumn, kCubeColumn, kFourthColumn})
        columns.add(column);
    }
    if (has_sign) columns.add(kSignColumn);
    if (fits_delay_) columns.add(kDriveSlopeColumn);
    columns.keeps_even_noise = keeps_even_noise;
    return columns;
  }

  FitColumns late_columns() const {
    FitColumns late = columns(true, true, true);
    if (!fits_delay_) late.add(kDriveSlopeColumn);
    return late;
  }

  void judge() {
    using std::sqrt;
    const Fit P(data_, columns(false, false, false)), P0(data_, columns(false, false, true)),
        S(data_, columns(true, false, !fits_delay_)), E(data_, columns(true, true, false)),
        E0(data_, columns(true, true, true));
    measure_motion();
    for (const Fit* fit : {&P, &P0, &E, &E0}) note_residual(*fit);
    const FittedValue sliding = E0.fitted(kSignColumn), extended = E0.fitted(kVelocityColumn);
    const double share = sliding.value * data_.sum().product(kSignColumn, kVelocityColumn) /
                         data_.sum().product(kVelocityColumn, kVelocityColumn);

    if (!is_mass_known()) mass_ = mass_of(P, E);

    Candidate viscous{P0.fitted(kVelocityColumn)}, sprung{S.fitted(kVelocityColumn)};
    viscous.discrepancy2 = square(sprung.fit.value - viscous.fit.value) + square(share / 10) +
                           square(viscous.fit.correction);
    sprung.discrepancy2 = square(share / 10) + square(sprung.fit.correction);
    if (fits_delay_) {
      const double both = extended.value + share;
      viscous.discrepancy2 += square((both - viscous.fit.value) / 2);
      sprung.discrepancy2 += square((both - sprung.fit.value) / 2);
    }
    friction_ = parameters_.coulomb_N.sd > 0 ? Candidate{extended} : better(viscous, sprung);

    stiffness_ = {P.fitted(kPositionColumn)};
    stiffness_.discrepancy2 = square(E.value(kPositionColumn) - stiffness_.fit.value);
    offset_ = {P.fitted(kOneColumn)};
    offset_.discrepancy2 = square(E.value(kOneColumn) - offset_.fit.value);
    coulomb_ = {sliding};
    if (fits_delay_) {
      const bool fits_sliding = parameters_.coulomb_N.sd > 0;
      delay_ = {(fits_sliding ? E : P).fitted(kDriveSlopeColumn)};
      delay_.discrepancy2 = square((E.value(kDriveSlopeColumn) - delay_.fit.value) / 2);
    }
    keep_plain(!is_mass_known() && P.fitted(kAccelerationColumn).is_known() ? P : P0);
    find_pairs();
    if (is_mass_known()) {
      test_with_free_mass();
    } else {
      test(E, P0);
    }
  }
  void test_with_free_mass() {
    const Fit P(data_, columns(MassModel::fitted, false, false, false)),
        P0(data_, columns(MassModel::fitted, false, false, true)),
        E(data_, columns(MassModel::fitted, true, true, false));
    for (const Fit* fit : {&P, &P0, &E}) note_residual(*fit);
    mass_ = mass_of(P, E);
    test(E, P0);
  }
  void note_residual(const Fit& fit) {
    if (fit.is_solved() && fit.residual() < residual_) residual_ = fit.residual();
  }

  bool is_mass_known() const { return parameters_.mass == MassModel::known; }

  Candidate mass_of(const Fit& P, const Fit& E) const {
    Candidate plain{P.fitted(kAccelerationColumn)}, shaped{E.fitted(kAccelerationColumn)};
    const double apart = shaped.fit.value - plain.fit.value;
    plain.discrepancy2 = square(apart);
    shaped.discrepancy2 = square(apart / 2);
    return better(plain, shaped);
  }

  void keep_plain(const Fit& fit) {
    if (!fit.is_solved()) return;
    plain_.friction_Ns_m = Scalar(fit.value(kVelocityColumn));
    plain_.mass_kg =
        Scalar(is_mass_known() ? parameters_.mass_kg.mean : fit.value(kAccelerationColumn));
    plain_.stiffness_N_m = Scalar(fit.value(kPositionColumn));
    plain_.offset_N =
        Scalar(data_.setup().place_m * fit.value(kPositionColumn) - fit.value(kOneColumn));
    plain_.delay_s =
        Scalar(parameters_.drive.delay_s + (fits_delay_ ? fit.value(kDriveSlopeColumn) : 0));
  }

  // rms of the motion, noise taken out.
  void measure_motion() {
    const RegressionSums<double>& sum = data_.sum();
    const auto mean2 = [&](RegressionColumn column) {
      return (sum.product(column, column) - data_.noise(sum, column, column)) / sum.instants;
    };
    using std::sqrt;
    rms_a_ = sqrt(mean2(kAccelerationColumn));
    rms_v_ = sqrt(mean2(kVelocityColumn));
    rms_x_ = sqrt(mean2(kPositionColumn) -
                  square(sum.product(kPositionColumn, kOneColumn) / sum.instants));
    rms_u_ = sqrt(mean2(kDriveColumn));
    rms_u_about_mean_ =
        sqrt(mean2(kDriveColumn) - square(sum.product(kDriveColumn, kOneColumn) / sum.instants));
  }

  Candidate better(const Candidate& one, const Candidate& other) const {
    if (!one.fit.is_known()) return other.fit.is_known() ? other : one;
    return other.all2(delay_sd_s_) < one.all2(delay_sd_s_) ? other : one;
  }

  // What mass and friction would be known to, were the other of the pair known.
  void find_pairs() {
    FitColumns free = columns(false, false, false), still = columns(false, false, true);
    FitColumns without_spring, without_delay;
    for (std::size_t i = 0; i < free.count; ++i) {
      if (free.columns[i] != kPositionColumn) without_spring.add(free.columns[i]);
    }
    for (std::size_t i = 0; i < still.count; ++i) {
      if (still.columns[i] != kDriveSlopeColumn) without_delay.add(still.columns[i]);
    }
    without_delay.keeps_even_noise = true;
    mass_alone_sd_ = is_mass_known() ? FittedValue::kUnbounded
                                     : Fit(data_, without_spring).fitted(kAccelerationColumn).sd;
    friction_alone_sd_ = fits_delay_ ? Fit(data_, without_delay).fitted(kVelocityColumn).sd
                                     : FittedValue::kUnbounded;
  }

  void test(const Fit& E, const Fit& P0) {
    using std::abs;
    using std::sqrt;
    constexpr double kDynamics = 3, kDelay = 4, kNegative = 3, kMassStated = 3;
    const Fit late(data_, late_columns());
    note_residual(late);
    const FittedValue delay = late.fitted(kDriveSlopeColumn);  // beyond what is stated
    FitColumns curved = columns(MassModel::fitted, true, true, false);
    if (fits_delay_) --curved.count;
    curved.add(kDriveCurvatureColumn);
    if (fits_delay_) curved.add(kDriveSlopeColumn);
    const FittedValue curvature = Fit(data_, curved).fitted(kDriveCurvatureColumn);
    const double stated_sd_s = parameters_.drive.delay_sd_s;
    const double independent = data_.duration_s() * data_.setup().cutoff_rad_s / 3.55;
    const double highest = 1.25 + 3 * sqrt(2 / independent);
    const double delay_sd_s =
        sqrt(square(delay.sd) + square(delay.correction) + square(stated_sd_s) +
             scale2() * square(delay.value - parameters_.mass_kg.mean * delay.per_known_mass));
    const double curvature_sd = sqrt(Candidate{curvature}.all2(delay_sd_s_));
    if (!is_noise_white_) {
      smoothing_s4_ = curvature.is_known() ? square(curvature.value) + square(curvature_sd)
                                           : FittedValue::kUnbounded;
    }
    const double mass = mass_.fit.value,
                 mass_sd = sqrt(mass_.all2(delay_sd_s_) + scale2() * square(mass) +
                                square(missing_N() / rms_a_) + known_mass_variance());
    if (is_mass_known()) {
      if (mass_.fit.is_known() && abs(mass - parameters_.mass_kg.mean) > kMassStated * mass_sd) {
        failure_ = JointLimit::mass_stated;
      }
    } else if (mass_.fit.is_known() && mass < -kNegative * mass_sd) {
      failure_ = JointLimit::drive_reversed;
    } else if (mass_.fit.is_known() && (mass + kNegative * mass_sd < parameters_.least_mass_kg ||
                                        mass - kNegative * mass_sd > parameters_.most_mass_kg)) {
      failure_ = JointLimit::implausible_mass;
    }
    if (failure_ != JointLimit::none) return;
    if (residual_ < FittedValue::kUnbounded && residual_ > highest) {
      failure_ = JointLimit::noise;
    } else if (curvature.is_known() && abs(curvature.value) > kDynamics * curvature_sd) {
      failure_ = JointLimit::dynamics;
    } else if (delay.is_known() && abs(delay.value) > kDelay * delay_sd_s) {
      failure_ = JointLimit::delay_stated;
    } else if (!has_walk(parameters_) &&
               (has_trend(P0.fitted(kVelocityColumn)) || has_trend(E.fitted(kAccelerationColumn)) ||
                has_trend(delay))) {
      failure_ = JointLimit::changing;
    } else if (friction_.fit.is_known() &&
               friction_.fit.value <
                   -kNegative * sqrt(friction_.all2(delay_sd_s_) + square(missing_N() / rms_v_))) {
      failure_ = JointLimit::negative_friction;
    }
  }

  double missing_N() const {
    return parameters_.drive.missing_share * (is_mass_known() ? rms_u_about_mean_ : rms_u_);
  }
  double known_mass_variance() const {
    return is_mass_known() ? square(parameters_.mass_kg.sd) : 0;
  }

  // Relative variance of the one scale of drive, positions and axis.
  double scale2() const {
    const DriveParameters& drive = parameters_.drive;
    return square(drive.gain_sd) + square(drive.position_scale_sd) +
           0.75 * square(square(drive.axis_angle_sd_rad));
  }

  // A delay within what is stated is no trend.
  bool has_trend(const FittedValue& fit) const {
    constexpr double kTrend = 3;
    return fit.is_known() &&
           square(fit.trend) >
               square(kTrend) * (fit.trend2 + square(delay_sd_s_ * fit.trend_per_delay));
  }

  // `per_N`: what a force of 1 N rms in phase adds to the value.
  void write(const Candidate& candidate, const JointPrior& prior, double resolution, double per_N,
             IdentifiedValue<Scalar>& value) const {
    using std::abs;
    using std::sqrt;
    const FittedValue& fit = candidate.fit;
    const DriveParameters& drive = parameters_.drive;
    const double T = data_.duration_s();
    const bool is_delay = &candidate == &delay_, is_friction = &candidate == &friction_,
               is_mass = &candidate == &mass_, is_offset = &candidate == &offset_;
    struct Part {
      double variance;
      JointLimit limit;
    };
    const Part parts[] = {
        {square(fit.sd), JointLimit::resolution},
        {candidate.discrepancy2,
         is_friction ? JointLimit::viscous_or_coulomb : JointLimit::mass_or_stiffness},
        {is_delay ? 0
                  : scale2() * square(fit.value - parameters_.mass_kg.mean * fit.per_known_mass),
         JointLimit::gain},
        {known_mass_variance() * square(fit.per_known_mass), JointLimit::gain},
        {candidate.delay2(delay_sd_s_), JointLimit::delay},
        {square(missing_N() * per_N), JointLimit::missing},
        {smoothing_s4_ * square(fit.per_delay2), JointLimit::smoothing},
        {square(((is_noise_white_ ? 0.1 : 0.25) + abs(residual_ - 1)) * fit.correction),
         JointLimit::excitation},
        {square(prior.walk_per_root_s) * T / 3, JointLimit::changing}};
    double sum = 0;
    const Part* largest = &parts[0];
    for (const Part& part : parts) {
      sum += part.variance;
      if (part.variance > largest->variance) largest = &part;
    }
    if (is_offset) {  // where x is 0, not where the recording began
      sum = square(sqrt(sum) + abs(data_.setup().place_m) * stiffness_.fit.sd);
    }
    value.fitted = Scalar(is_delay    ? drive.delay_s + fit.value
                          : is_offset ? data_.setup().place_m * stiffness_.fit.value - fit.value
                                      : fit.value);
    value.fitted_sd = Scalar(sqrt(sum));
    value.sampling_sd = Scalar(fit.sd);
    const double target = square(resolution / 2);
    const bool suffices = sum <= target;
    if (failure_ != JointLimit::none) {
      value.limit = failure_;
    } else if (suffices) {
      value.limit = JointLimit::none;
      value.quantity = {value.fitted, value.fitted_sd, Provenance::measured};
    } else if (!fit.is_known() || largest->limit == JointLimit::resolution) {
      const double alone_sd = is_mass       ? mass_alone_sd_
                              : is_friction ? friction_alone_sd_
                                            : FittedValue::kUnbounded;
      const double others = sum - parts[0].variance;
      const bool would_do = alone_sd < FittedValue::kUnbounded &&
                            square(alone_sd) + (fit.is_known() ? others : 0) <= target;
      value.limit = would_do
                        ? (is_mass ? JointLimit::mass_or_stiffness : JointLimit::friction_or_delay)
                    : fit.is_known() ? JointLimit::resolution
                                     : JointLimit::excitation;
      if (value.limit == JointLimit::resolution && others < target) {
        value.needed_s = Scalar(T * parts[0].variance / (target - others));
      }
    } else {
      value.limit = largest->limit;
    }
  }

  const JointParameters& parameters_;
  RegressionData<Scalar> data_;
  bool fits_delay_;
  double delay_sd_s_;
  bool is_noise_white_;
  double smoothing_s4_ = 0;  // of u'': what may be left
  double residual_ = FittedValue::kUnbounded;
  double rms_a_ = 0, rms_v_ = 0, rms_x_ = 0, rms_u_ = 0, rms_u_about_mean_ = 0;
  double mass_alone_sd_ = FittedValue::kUnbounded, friction_alone_sd_ = FittedValue::kUnbounded;
  PointValues<Scalar> plain_;
  Candidate mass_, friction_, stiffness_, offset_, coulomb_, delay_;
  JointLimit failure_ = JointLimit::none;
};

}  // namespace internal
}  // namespace condyle
