// SPDX-License-Identifier: Apache-2.0
// A point of the jaw driven by a known force along one axis, and held by friction and a spring.
//
//   p, v      position (m), velocity (m/s)
//   u         the drive: all of the force but inertia, friction and spring (N); linear from sample
//             to sample (first-order hold): u0 at the last one, u1 at this one
//   lambda    kv / m, rate of damping (1/s)
//   eta       1 / m (1/kg)
//   kappa     ks / m (1/s^2)
//   c         constant force / m (m/s^2)
//   T         time step (s)
//
// Model:       p' = v,   v' = eta u + c - lambda v - kappa p
// Transition:  linear in p0, v0, eta u0 and eta u1, so it is given by its responses to one unit of
//              each and by their derivatives with respect to lambda and kappa; c acts as a drive
//              eta u0 = eta u1 = c. Exact, by the Taylor series over the step, whose coefficients
//              follow from each other: with t = s T, 0 <= s <= 1,
//                p_(k+1) = T v_k / (k+1)
//                v_(k+1) = T (f_k - lambda v_k - kappa p_k) / (k+1)
//              f_k: those of 1 - s and s for the two drives, which end with k = 1. A derivative of
//              a response obeys the same recursion with another f: that of d/dlambda is -v, of
//              d/dkappa -p. Long steps are taken in equal parts.
//
// (lambda, eta), not (kv, m): the right-hand side is linear in every parameter, so that a filter
// that starts far off does not diverge. The rest is model section 4 of the paper's eq 24 with the
// spring that its section 5 names.
#pragma once

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// Rates of a driven point; see above.
template <class Scalar>
struct DrivenRates {
  Scalar lambda = 0, eta = 0, kappa = 0, c = 0;
};

/// The inputs of a step: the columns of DrivenResponse.
enum DrivenCause { kFromPosition, kFromVelocity, kFromDriveBefore, kFromDrive, kDrivenCauses };

/// Position (row 0) and velocity (row 1) after a step for one unit of p0, v0, eta u0 or eta u1, and
/// the derivatives of these responses.
template <class Scalar>
struct DrivenResponse {
  using Table = Eigen::Array<Scalar, 2, kDrivenCauses>;
  Table value = Table::Zero(), of_lambda = Table::Zero(), of_kappa = Table::Zero();
};

/// Places of the sensitivities in DrivenStep.
enum DrivenColumn {
  kSolution,
  kOfPosition,
  kOfVelocity,
  kOfDriveBefore,
  kOfDrive,
  kOfLambda,
  kOfEta,
  kOfKappa,
  kOfOffset,
  kDrivenColumns
};

/// Position and velocity after a step, and their derivatives with respect to their inputs.
template <class Scalar>
struct DrivenStep {
  using Row = Eigen::Array<Scalar, 1, kDrivenColumns>;
  Row position = Row::Zero();  ///< (m), and m per unit of each column's quantity
  Row velocity = Row::Zero();  ///< (m/s), likewise
};

namespace internal {

/// Adds one part of a step of `part_s` s; its ends lie at the shares `begin` and `end` of the step.
template <class Scalar>
void add_part(const DrivenRates<Scalar>& rates, Scalar part_s, Scalar begin, Scalar end,
              DrivenResponse<Scalar>& response) {
  using Table = typename DrivenResponse<Scalar>::Table;
  constexpr int kTerms = 20;  // 1 / 20! is 4e-19
  const auto next = [&rates](const Table& terms, const auto& f, Scalar share) {
    Table after;
    after.row(0) = share * terms.row(1);
    after.row(1) = share * (f - rates.lambda * terms.row(1) - rates.kappa * terms.row(0));
    return after;
  };
  DrivenResponse<Scalar> term = response;
  for (int k = 0; k < kTerms; ++k) {
    Eigen::Array<Scalar, 1, kDrivenCauses> f = Eigen::Array<Scalar, 1, kDrivenCauses>::Zero();
    if (k == 0) {
      f[kFromDriveBefore] = Scalar(1) - begin;
      f[kFromDrive] = begin;
    } else if (k == 1) {
      f[kFromDriveBefore] = begin - end;
      f[kFromDrive] = end - begin;
    }
    const Scalar share = part_s / Scalar(k + 1);
    term.of_lambda = next(term.of_lambda, -term.value.row(1), share);
    term.of_kappa = next(term.of_kappa, -term.value.row(0), share);
    term.value = next(term.value, f, share);
    response.value += term.value;
    response.of_lambda += term.of_lambda;
    response.of_kappa += term.of_kappa;
  }
}

}  // namespace internal

/// The responses over a step of `T` s. Finite for finite arguments; exact to rounding for
/// T (|lambda| + sqrt |kappa|) up to 64.
template <class Scalar>
DrivenResponse<Scalar> driven_response(const DrivenRates<Scalar>& rates, Scalar T) {
  using std::abs;
  using std::sqrt;
  constexpr int kMostParts = 64;
  const Scalar speed = T * (abs(rates.lambda) + sqrt(abs(rates.kappa)));
  int parts = 1;
  while (parts < kMostParts && speed > Scalar(parts)) ++parts;

  DrivenResponse<Scalar> response;
  response.value(0, kFromPosition) = Scalar(1);
  response.value(1, kFromVelocity) = Scalar(1);
  for (int i = 0; i < parts; ++i) {
    internal::add_part(rates, T / Scalar(parts), Scalar(i) / Scalar(parts),
                       Scalar(i + 1) / Scalar(parts), response);
  }
  return response;
}

/// The step with these responses from position `p` and velocity `v`, with the drive going from `u0`
/// to `u1`.
template <class Scalar>
DrivenStep<Scalar> driven_step(const DrivenRates<Scalar>& rates,
                               const DrivenResponse<Scalar>& response, Scalar p, Scalar v,
                               Scalar u0, Scalar u1) {
  Eigen::Array<Scalar, kDrivenCauses, 1> causes;
  causes << p, v, rates.eta * u0 + rates.c, rates.eta * u1 + rates.c;
  const auto row = [&](int i) {
    const auto value = response.value.row(i).matrix();
    typename DrivenStep<Scalar>::Row entries;
    entries[kSolution] = value.dot(causes.matrix());
    entries[kOfPosition] = value[kFromPosition];
    entries[kOfVelocity] = value[kFromVelocity];
    entries[kOfDriveBefore] = rates.eta * value[kFromDriveBefore];
    entries[kOfDrive] = rates.eta * value[kFromDrive];
    entries[kOfLambda] = response.of_lambda.row(i).matrix().dot(causes.matrix());
    entries[kOfEta] = value[kFromDriveBefore] * u0 + value[kFromDrive] * u1;
    entries[kOfKappa] = response.of_kappa.row(i).matrix().dot(causes.matrix());
    entries[kOfOffset] = value[kFromDriveBefore] + value[kFromDrive];
    return entries;
  };
  return {row(0), row(1)};
}

/// The same for `T` s.
template <class Scalar>
DrivenStep<Scalar> driven_step(const DrivenRates<Scalar>& rates, Scalar T, Scalar p, Scalar v,
                               Scalar u0, Scalar u1) {
  return driven_step(rates, driven_response(rates, T), p, v, u0, u1);
}

}  // namespace condyle
