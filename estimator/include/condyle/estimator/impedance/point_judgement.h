// SPDX-License-Identifier: Apache-2.0
// What some blocks of a recording show of the point: the values of point_candidate.h with their
// full uncertainty, unless a test of point_tests.h fails.
//
//   P, P0, E, E0   fits of point_candidate.h
//   V, d      scatter and discrepancy of the value that is taken
//   R         the smallest residual of the fits
//
// Granted, each apart from the others, beside V and d^2:
//   gain      sigma_g (theta - m_0 dtheta/dm_0), one scale of all: sigma_g^2 = gain^2 + scale^2 +
//             3/4 angle^4 (a force at an angle A counts with cos A, which is 1 - A^2 / 2). If the
//             mass is known, the motion shows the scale, m / m_0: what it shows beyond 2 of its
//             standard deviations counts for sigma_g if it is more
//   delay     known to s: s times what a second of delay adds, to second order; by regression
//   missing   a force of at most the share s of the total, in phase with v or a:
//             s / (1 - s) rms(u) / rms(v); if the mass is known, u about its mean; unbounded at s =
//             1
//   mass      sigma_m dtheta/dm_0
//   smoothing if the noise of the positions is not white, what a square second of u''
//             adds, times what the test of dynamics leaves open: the root of u''^2 + V
//   noise     (0.1 + |R - 1|) times the correction for noise, 0.25 if it is not white
// Measured: standard deviation, all of it, at most half the resolution that the user asks for.
#pragma once

#include <algorithm>

#include "condyle/estimator/impedance/point_tests.h"

namespace condyle {

namespace internal {

/// The results of the blocks from one on. Fixed size, no allocation; about 10 kB of stack.
template <class Scalar>
class PointJudgement {
 public:
  PointJudgement(const RegressionBlocks<Scalar>& blocks, const RegressionSetup& setup,
                 const ImpedanceParameters& parameters, std::size_t first)
      : parameters_(parameters),
        columns_(parameters),
        data_(blocks, setup, first),
        rms_(PointMotion::of(data_)),
        stated_(parameters, rms_),
        is_noise_white_(!data_.has_coloured_positions()) {
    judge();
  }

  void write(ImpedanceEstimate<Scalar>& estimate) const {
    using std::sqrt;
    estimate.used_s = Scalar(data_.duration_s());
    estimate.drive_noise_sd_N = Scalar(sqrt(data_.drive_variance_N2()));
    estimate.position_noise_sd_m = Scalar(sqrt(data_.position_variance_m2()));
    estimate.residual_ratio = Scalar(residual_);
    estimate.plain = plain_;
    estimate.drive_rms_N = Scalar(rms_.u);
    estimate.drive_variation_rms_N = Scalar(rms_.u_about_mean);
    estimate.velocity_rms_m_s = Scalar(rms_.v);
    estimate.position_rms_m = Scalar(rms_.x);
    write(value_.mass, parameters_.mass_kg,
          parameters_.mass_resolution_fraction * value_.mass.fit.value, 1 / rms_.a,
          estimate.mass_kg);
    write(value_.friction, parameters_.friction_Ns_m, parameters_.friction_resolution_Ns_m,
          1 / rms_.v, estimate.friction_Ns_m);
    const auto by_prior = [](const ImpedancePrior& prior) { return sqrt(2.0) * prior.sd; };
    write(value_.stiffness, parameters_.stiffness_N_m, by_prior(parameters_.stiffness_N_m),
          1 / rms_.x, estimate.stiffness_N_m);
    write(value_.offset, parameters_.offset_N, by_prior(parameters_.offset_N), 1,
          estimate.offset_N);
    if (columns_.fits_sliding()) {
      write(value_.coulomb, parameters_.coulomb_N, by_prior(parameters_.coulomb_N), 1,
            estimate.coulomb_N);
    }
    if (!columns_.fits_delay()) return;
    const ImpedancePrior stated{parameters_.drive.delay_s, parameters_.drive.delay_sd_s, 0};
    write(value_.delay, stated, by_prior(stated), 0, estimate.delay_s);
  }

 private:
  using Fit = RegressionFit<Scalar>;
  static constexpr double kShownScale = 2;

  void judge() {
    const Fit P(data_, columns_.of(false, false, false)),
        P0(data_, columns_.of(false, false, true)),
        S(data_, columns_.of(true, false, !columns_.fits_delay())),
        E(data_, columns_.of(true, true, false)), E0(data_, columns_.of(true, true, true));
    for (const Fit* fit : {&P, &P0, &E, &E0}) residual_ = fit->lower_residual(residual_);
    if (!columns_.is_mass_known()) value_.mass = mass_candidate(P, E, columns_.delay_sd_s());
    add_friction(columns_, P0, S, E0, data_.sum().product(kSignColumn, kVelocityColumn),
                 data_.sum().product(kVelocityColumn, kVelocityColumn), value_);
    add_others(columns_, P, E, value_);
    keep_plain(!columns_.is_mass_known() && P.fitted(kAccelerationColumn).is_known() ? P : P0);
    find_pairs();
    if (columns_.is_mass_known()) {
      test_with_free_mass();
    } else {
      test(E, P0);
    }
  }
  void test_with_free_mass() {
    const Fit P(data_, columns_.of(MassModel::fitted, false, false, false)),
        P0(data_, columns_.of(MassModel::fitted, false, false, true)),
        E(data_, columns_.of(MassModel::fitted, true, true, false));
    for (const Fit* fit : {&P, &P0, &E}) residual_ = fit->lower_residual(residual_);
    value_.mass = mass_candidate(P, E, columns_.delay_sd_s());
    test(E, P0);
  }
  void test(const Fit& E, const Fit& P0) {
    const PointTests<Scalar> tests(data_, parameters_, rms_, stated_, E, P0, value_.mass,
                                   value_.friction, residual_);
    failure_ = tests.failure();
    smoothing_s4_ = is_noise_white_ ? 0 : tests.curvature_s4();
  }

  void keep_plain(const Fit& fit) {
    if (!fit.is_solved()) return;
    plain_.friction_Ns_m = Scalar(fit.value(kVelocityColumn));
    plain_.mass_kg = Scalar(columns_.is_mass_known() ? parameters_.mass_kg.mean
                                                     : fit.value(kAccelerationColumn));
    plain_.stiffness_N_m = Scalar(fit.value(kPositionColumn));
    plain_.offset_N =
        Scalar(data_.setup().place_m * fit.value(kPositionColumn) - fit.value(kOneColumn));
    plain_.delay_s = Scalar(parameters_.drive.delay_s +
                            (columns_.fits_delay() ? fit.value(kDriveSlopeColumn) : 0));
  }

  // The uncertainty of mass and friction if the other of the pair were known.
  void find_pairs() {
    if (!columns_.is_mass_known()) {
      mass_alone_sd_ = Fit(data_, columns_.without_spring()).fitted(kAccelerationColumn).sd;
    }
    if (columns_.fits_delay()) {
      friction_alone_sd_ = Fit(data_, columns_.without_delay()).fitted(kVelocityColumn).sd;
    }
  }

  double believed_scale2() const {
    const double stated = stated_.scale2();
    const Candidate& mass = value_.mass;
    if (!columns_.is_mass_known() || !mass.fit.is_known()) return stated;
    const double known = parameters_.mass_kg.mean;
    const double departure2 = square(mass.fit.value - known);
    const double variance =
        mass.all2(columns_.delay_sd_s()) + square(stated_.tested_missing_N() / rms_.a);
    if (!(departure2 > square(kShownScale) * variance)) return stated;
    return std::max(stated, (departure2 - stated_.mass_variance()) / square(known));
  }

  // An unknown force may change any value, the delay too.
  double missing2(double per_N) const {
    const double missing_N = stated_.missing_N();
    return missing_N < FittedValue::kUnbounded ? square(missing_N * per_N)
                                               : FittedValue::kUnbounded;
  }

  // `per_N`: effect on the value of a force of 1 N rms in phase.
  void write(const Candidate& candidate, const ImpedancePrior& prior, double resolution,
             double per_N, IdentifiedValue<Scalar>& value) const {
    using std::abs;
    using std::sqrt;
    const FittedValue& fit = candidate.fit;
    const DriveParameters& drive = parameters_.drive;
    const double T = data_.duration_s();
    const bool is_delay = &candidate == &value_.delay, is_friction = &candidate == &value_.friction,
               is_mass = &candidate == &value_.mass, is_offset = &candidate == &value_.offset;
    struct Part {
      double variance;
      ImpedanceLimit limit;
    };
    const Part parts[] = {
        {square(fit.sd), ImpedanceLimit::resolution},
        {candidate.discrepancy2,
         is_friction ? ImpedanceLimit::viscous_or_coulomb : ImpedanceLimit::mass_or_stiffness},
        {is_delay ? 0
                  : believed_scale2() *
                        square(fit.value - parameters_.mass_kg.mean * fit.per_known_mass),
         ImpedanceLimit::gain},
        {stated_.mass_variance() * square(fit.per_known_mass), ImpedanceLimit::gain},
        {candidate.delay2(columns_.delay_sd_s()), ImpedanceLimit::delay},
        {missing2(per_N), ImpedanceLimit::missing},
        {smoothing_s4_ * square(fit.per_delay2), ImpedanceLimit::smoothing},
        {square(((is_noise_white_ ? 0.1 : 0.25) + abs(residual_ - 1)) * fit.correction),
         ImpedanceLimit::excitation},
        {square(prior.walk_per_root_s) * T / 3, ImpedanceLimit::changing}};
    double sum = 0;
    const Part* largest = &parts[0];
    for (const Part& part : parts) {
      sum += part.variance;
      if (part.variance > largest->variance) largest = &part;
    }
    if (is_offset) {  // at x = 0, not at the place where the recording began
      sum = square(sqrt(sum) + abs(data_.setup().place_m) * value_.stiffness.fit.sd);
    }
    value.fitted =
        Scalar(is_delay    ? drive.delay_s + fit.value
               : is_offset ? data_.setup().place_m * value_.stiffness.fit.value - fit.value
                           : fit.value);
    value.fitted_sd = Scalar(sqrt(sum));
    value.sampling_sd = Scalar(fit.sd);
    const double target = square(resolution / 2);
    const bool suffices = sum <= target;
    if (failure_ != ImpedanceLimit::none) {
      value.limit = failure_;
    } else if (suffices) {
      value.limit = ImpedanceLimit::none;
      value.quantity = {value.fitted, value.fitted_sd, Provenance::measured};
    } else if (!fit.is_known() || largest->limit == ImpedanceLimit::resolution) {
      const double alone_sd = is_mass       ? mass_alone_sd_
                              : is_friction ? friction_alone_sd_
                                            : FittedValue::kUnbounded;
      const double others = sum - parts[0].variance;
      const bool would_do = alone_sd < FittedValue::kUnbounded &&
                            square(alone_sd) + (fit.is_known() ? others : 0) <= target;
      value.limit = would_do         ? (is_mass ? ImpedanceLimit::mass_or_stiffness
                                                : ImpedanceLimit::friction_or_delay)
                    : fit.is_known() ? ImpedanceLimit::resolution
                                     : ImpedanceLimit::excitation;
      if (value.limit == ImpedanceLimit::resolution && others < target) {
        value.needed_s = Scalar(T * parts[0].variance / (target - others));
      }
    } else {
      value.limit = largest->limit;
    }
  }

  const ImpedanceParameters& parameters_;
  PointColumns columns_;
  RegressionData<Scalar> data_;
  PointMotion rms_;
  PointStatement stated_;
  bool is_noise_white_;
  double smoothing_s4_ = 0;  // of u'': what may remain
  double residual_ = FittedValue::kUnbounded;
  double mass_alone_sd_ = FittedValue::kUnbounded, friction_alone_sd_ = FittedValue::kUnbounded;
  PointValues<Scalar> plain_;
  PointCandidates value_;
  ImpedanceLimit failure_ = ImpedanceLimit::none;
};

}  // namespace internal
}  // namespace condyle
