// SPDX-License-Identifier: Apache-2.0
// The fits by which the blocks of a recording are judged, and the values they offer.
//
//   P, P0     the plain fit of m, kv, ks, c (and tau, if the delay is fitted): noise taken out
//             of all columns, or kept in the even ones (regression_fit.h)
//   S         P0 with X^2, X^3, X^4 beside: a spring of any shape. If the delay is fitted, P
//             with these: u' is odd as v is, yet a motion that differs from itself played
//             backwards couples it with X^k, whose noise may then not be kept
//   E, E0     P, P0 with X^2, X^3, X^4 and the sign of the velocity: also sliding friction
//   V         variance of a value by the scatter of the blocks
//   Fc, f     Fc of E0; f = Fc sum q_s v / sum v^2: sliding friction as damping of the same energy
//   d         discrepancy: difference of another fit's value
//
// Known mass: a has no column, and these are fitted to u - m_0 a.
// Candidates: each value has some. The one with the smallest sum of V, d^2 and the delay's part is
// taken:
//   mass      P: d = m_E - m_P.  E: d = (m_P - m_E) / 2
//   friction  P0: d = kv_S - kv_P.  S: d = 0. Either with 0.1 f and the correction for noise, and
//             with half of kv_E + f - kv if the delay is fitted. If Coulomb friction is
//             fitted, E0 alone: kv is then the viscous part
//   others    stiffness and offset P: d to E. Coulomb friction E0. Delay P: d is half of that to E;
//             E if Coulomb friction is fitted
// The delay, known to s, adds s times the effect of a second of delay, to second order; by
// regression.
#pragma once

#include "condyle/estimator/impedance/impedance_parameters.h"
#include "condyle/estimator/impedance/regression_fit.h"

namespace condyle {

/// True if a parameter is stated to wander.
inline bool has_walk(const ImpedanceParameters& parameters) {
  for (const ImpedancePrior* prior :
       {&parameters.friction_Ns_m, &parameters.mass_kg, &parameters.stiffness_N_m,
        &parameters.offset_N, &parameters.coulomb_N}) {
    if (prior->walk_per_root_s > 0) return true;
  }
  return false;
}

namespace internal {

inline double square(double value) {
  return value * value;
}

/// A value of one fit, with its uncertainties other than scatter.
struct Candidate {
  FittedValue fit;
  double discrepancy2 = 0;
  double all2(double delay_sd_s) const {
    return square(fit.sd) + discrepancy2 + delay2(delay_sd_s);
  }
  double delay2(double delay_sd_s) const {
    return square(fit.per_delay * delay_sd_s) + 3 * square(fit.per_delay2 * square(delay_sd_s) / 2);
  }
};

/// The fits' columns.
class PointColumns {
 public:
  /// `parameters` must live as long as this.
  explicit PointColumns(const ImpedanceParameters& parameters) : parameters_(parameters) {}

  bool is_mass_known() const { return parameters_.mass == MassModel::known; }
  bool fits_delay() const { return parameters_.delay == DelayModel::fitted; }
  bool fits_sliding() const { return parameters_.coulomb_N.sd > 0; }
  /// A delay that is not fitted (s).
  double delay_sd_s() const { return fits_delay() ? 0 : parameters_.drive.delay_sd_s; }

  FitColumns of(bool has_powers, bool has_sign, bool keeps_even_noise) const {
    return of(parameters_.mass, has_powers, has_sign, keeps_even_noise);
  }
  FitColumns of(MassModel mass, bool has_powers, bool has_sign, bool keeps_even_noise) const {
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
    if (fits_delay()) columns.add(kDriveSlopeColumn);
    columns.keeps_even_noise = keeps_even_noise;
    return columns;
  }
  /// E0 with a delay.
  FitColumns late() const {
    FitColumns late = of(true, true, true);
    if (!fits_delay()) late.add(kDriveSlopeColumn);
    return late;
  }
  /// E with u'', the mass fitted.
  FitColumns curved() const {
    FitColumns curved = of(MassModel::fitted, true, true, false);
    if (fits_delay()) --curved.count;
    curved.add(kDriveCurvatureColumn);
    if (fits_delay()) curved.add(kDriveSlopeColumn);
    return curved;
  }
  /// P without x; P0 without tau.
  FitColumns without_spring() const {
    const FitColumns all = of(false, false, false);
    FitColumns rest;
    for (std::size_t i = 0; i < all.count; ++i) {
      if (all.columns[i] != kPositionColumn) rest.add(all.columns[i]);
    }
    return rest;
  }
  FitColumns without_delay() const {
    const FitColumns all = of(false, false, true);
    FitColumns rest;
    for (std::size_t i = 0; i < all.count; ++i) {
      if (all.columns[i] != kDriveSlopeColumn) rest.add(all.columns[i]);
    }
    rest.keeps_even_noise = true;
    rest.known_mass_kg = all.known_mass_kg;
    return rest;
  }

 private:
  const ImpedanceParameters& parameters_;
};

/// The selected values.
struct PointCandidates {
  Candidate mass, friction, stiffness, offset, coulomb, delay;
};

inline const Candidate& better(const Candidate& one, const Candidate& other, double delay_sd_s) {
  if (!one.fit.is_known()) return other.fit.is_known() ? other : one;
  return other.all2(delay_sd_s) < one.all2(delay_sd_s) ? other : one;
}

/// By P and E.
template <class Scalar>
Candidate mass_candidate(const RegressionFit<Scalar>& P, const RegressionFit<Scalar>& E,
                         double delay_sd_s) {
  Candidate plain{P.fitted(kAccelerationColumn)}, shaped{E.fitted(kAccelerationColumn)};
  const double apart = shaped.fit.value - plain.fit.value;
  plain.discrepancy2 = square(apart);
  shaped.discrepancy2 = square(apart / 2);
  return better(plain, shaped, delay_sd_s);
}

/// Friction and Coulomb friction, by P0, S and E0. `velocity2` and `sliding`: sums of v^2, q_s v.
template <class Scalar>
void add_friction(const PointColumns& columns, const RegressionFit<Scalar>& P0,
                  const RegressionFit<Scalar>& S, const RegressionFit<Scalar>& E0, double sliding,
                  double velocity2, PointCandidates& candidates) {
  const FittedValue coulomb = E0.fitted(kSignColumn), extended = E0.fitted(kVelocityColumn);
  const double share = coulomb.value * sliding / velocity2;
  Candidate viscous{P0.fitted(kVelocityColumn)}, sprung{S.fitted(kVelocityColumn)};
  viscous.discrepancy2 = square(sprung.fit.value - viscous.fit.value) + square(share / 10) +
                         square(viscous.fit.correction);
  sprung.discrepancy2 = square(share / 10) + square(sprung.fit.correction);
  if (columns.fits_delay()) {
    const double both = extended.value + share;
    viscous.discrepancy2 += square((both - viscous.fit.value) / 2);
    sprung.discrepancy2 += square((both - sprung.fit.value) / 2);
  }
  candidates.friction =
      columns.fits_sliding() ? Candidate{extended} : better(viscous, sprung, columns.delay_sd_s());
  candidates.coulomb = {coulomb};
}

/// Stiffness, offset and delay, by P and E.
template <class Scalar>
void add_others(const PointColumns& columns, const RegressionFit<Scalar>& P,
                const RegressionFit<Scalar>& E, PointCandidates& candidates) {
  candidates.stiffness = {P.fitted(kPositionColumn)};
  candidates.stiffness.discrepancy2 =
      square(E.value(kPositionColumn) - candidates.stiffness.fit.value);
  candidates.offset = {P.fitted(kOneColumn)};
  candidates.offset.discrepancy2 = square(E.value(kOneColumn) - candidates.offset.fit.value);
  if (!columns.fits_delay()) return;
  candidates.delay = {(columns.fits_sliding() ? E : P).fitted(kDriveSlopeColumn)};
  candidates.delay.discrepancy2 =
      square((E.value(kDriveSlopeColumn) - candidates.delay.fit.value) / 2);
}

}  // namespace internal
}  // namespace condyle
