// SPDX-License-Identifier: Apache-2.0
// Nonlinear observability of the paper's systems, eqs (24)-(43).
//
//   x        state;  f  dynamics x' = f(x, u);  y  measurements: the first states of x
//   u, u'    input and its rate of change; u'' = 0
//   L_k      Lie derivative of order k, the k-th time derivative of y:
//            L_0 = y,  L_k = (dL_{k-1}/dx) f + (dL_{k-1}/du) u'
//   O        observability matrix: the gradients dL_k/dx, k = 0 ... n-1, one below the other
//
// A system with n states is locally observable at (x, u, u') if O has rank n. Lie derivatives and
// gradients come from nested automatic differentiation of f (dual.h).
//
// Printed matrices that differ from the correct ones are kept, to show both:
//   (24)        k_s' = 0 in a system whose equations hold k_v: k_s is then a state that enters no
//               equation. Right: k_v' = 0.
//   (29)        the derivative of a row vector, which has no value. Right: (0 1 0 0).
//   (38), (39)  friction column u/m at order 1 and, following from it, -(kv/m) u/m - a/m at
//               order 2. Right: -v/m and (2 kv v - u)/m^2.
//   (43)        mass column at order 2 over m^4. Right: over m^2 (2 kv a / m^2 for constant u).
#pragma once

#include <limits>
#include <utility>

#include "condyle/estimator/math/arithmetic.h"
#include "condyle/estimator/math/eigen_solvers.h"
#include "observability/dual.h"
#include "observability/running_error.h"

namespace condyle {

/// A point at which observability is judged, SI units. A system reads the fields of its model.
template <class Scalar>
struct OperatingPoint {
  Scalar position_m = Scalar(0.005);
  Scalar velocity_m_s = Scalar(0.05);
  Scalar friction_Ns_m = Scalar(0.022);
  Scalar mass_kg = Scalar(0.25);
  Scalar force_N = Scalar(0.3);         ///< u; in stage 1 the net force
  Scalar force_rate_N_s = Scalar(1.0);  ///< u'

  /// Acceleration (u - kv v) / m (m/s^2), eqs (13), (15).
  constexpr Scalar acceleration_m_s2() const {
    return (force_N - friction_Ns_m * velocity_m_s) / mass_kg;
  }
};

/// Stage 1, eq (30): x = (p, v, F), p measured.
template <class Scalar>
struct MotionSystem {
  static constexpr int kStates = 3, kOutputs = 1;
  Scalar m0;
  explicit MotionSystem(const OperatingPoint<Scalar>& at) : m0(at.mass_kg) {}
  static Eigen::Matrix<Scalar, 3, 1> state(const OperatingPoint<Scalar>& at) {
    return {at.position_m, at.velocity_m_s, at.force_N};
  }
  template <class T>
  void f(const T* x, const T&, T* rate) const {
    rate[0] = x[1];
    rate[1] = x[2] / T(m0);
    rate[2] = T(0);
  }
};

/// Stage 2, eq (13): x = (p, v, kv), p and v measured, u known.
template <class Scalar>
struct FrictionSystem {
  static constexpr int kStates = 3, kOutputs = 2;
  Scalar m0;
  explicit FrictionSystem(const OperatingPoint<Scalar>& at) : m0(at.mass_kg) {}
  static Eigen::Matrix<Scalar, 3, 1> state(const OperatingPoint<Scalar>& at) {
    return {at.position_m, at.velocity_m_s, at.friction_Ns_m};
  }
  template <class T>
  void f(const T* x, const T& u, T* rate) const {
    rate[0] = x[1];
    rate[1] = (u - x[2] * x[1]) / T(m0);
    rate[2] = T(0);
  }
};

/// Stage 3, eq (15): x = (p, v, m), p and v measured, u and kv known.
template <class Scalar>
struct MassSystem {
  static constexpr int kStates = 3, kOutputs = 2;
  Scalar kv;
  explicit MassSystem(const OperatingPoint<Scalar>& at) : kv(at.friction_Ns_m) {}
  static Eigen::Matrix<Scalar, 3, 1> state(const OperatingPoint<Scalar>& at) {
    return {at.position_m, at.velocity_m_s, at.mass_kg};
  }
  template <class T>
  void f(const T* x, const T& u, T* rate) const {
    rate[0] = x[1];
    rate[1] = (u - T(kv) * x[1]) / x[2];
    rate[2] = T(0);
  }
};

/// Eq (24), corrected: x = (p, v, kv, m), p measured, u known.
template <class Scalar>
struct FullSystem {
  static constexpr int kStates = 4, kOutputs = 1;
  explicit FullSystem(const OperatingPoint<Scalar>&) {}
  static Eigen::Matrix<Scalar, 4, 1> state(const OperatingPoint<Scalar>& at) {
    return {at.position_m, at.velocity_m_s, at.friction_Ns_m, at.mass_kg};
  }
  template <class T>
  void f(const T* x, const T& u, T* rate) const {
    rate[0] = x[1];
    rate[1] = (u - x[2] * x[1]) / x[3];
    rate[2] = rate[3] = T(0);
  }
};

/// Eq (24) as printed: x = (p, v, k_s, m), p measured, u known; k_s enters no equation.
template <class Scalar>
struct PrintedFullSystem {
  static constexpr int kStates = 4, kOutputs = 1;
  Scalar kv;
  explicit PrintedFullSystem(const OperatingPoint<Scalar>& at) : kv(at.friction_Ns_m) {}
  static Eigen::Matrix<Scalar, 4, 1> state(const OperatingPoint<Scalar>& at) {
    return {at.position_m, at.velocity_m_s, 0, at.mass_kg};
  }
  template <class T>
  void f(const T* x, const T& u, T* rate) const {
    rate[0] = x[1];
    rate[1] = (u - T(kv) * x[1]) / x[3];
    rate[2] = rate[3] = T(0);
  }
};

/// Eq (24) with the drive unknown: x = (p, v, kv, m, u, u'), p measured. One factor on kv, m, u and
/// u' together leaves the motion unchanged, so the rank never exceeds 5.
template <class Scalar>
struct UnknownDriveSystem {
  static constexpr int kStates = 6, kOutputs = 1;
  explicit UnknownDriveSystem(const OperatingPoint<Scalar>&) {}
  static Eigen::Matrix<Scalar, 6, 1> state(const OperatingPoint<Scalar>& at) {
    Eigen::Matrix<Scalar, 6, 1> x;
    x << at.position_m, at.velocity_m_s, at.friction_Ns_m, at.mass_kg, at.force_N,
        at.force_rate_N_s;
    return x;
  }
  template <class T>
  void f(const T* x, const T&, T* rate) const {
    rate[0] = x[1];
    rate[1] = (x[4] - x[2] * x[1]) / x[3];
    rate[2] = rate[3] = rate[5] = T(0);
    rate[4] = x[5];
  }
};

/// Lie derivative L_`order` of measurement `output` at state `x`, input `u` and its rate (eq 25
/// f.): the slope of L_{order-1} when x moves along f and u along u'.
template <int order, class System, class T>
T lie_derivative(const System& system, int output, const T* x, const T& u, const T& u_rate) {
  if constexpr (order == 0) {
    return x[output];
  } else {
    T rate[System::kStates];
    system.f(x, u, rate);
    Dual<T> moving[System::kStates];
    for (int i = 0; i < System::kStates; ++i) moving[i] = {x[i], rate[i]};
    return lie_derivative<order - 1>(system, output, moving, Dual<T>(u, u_rate),
                                     Dual<T>(u_rate, T(0)))
        .slope;
  }
}

/// An observability matrix with the size of the summed terms for each entry.
template <class Scalar, int rows, int columns>
struct ObservabilityMatrix {
  Eigen::Matrix<Scalar, rows, columns> O;
  Eigen::Matrix<Scalar, rows, columns> term_size;

  /// Replaces an entry.
  void replace(int row, int column, const RunningError<Scalar>& entry) {
    O(row, column) = entry.value;
    term_size(row, column) = entry.size;
  }
};

/// Builds O of `System` at `point` (eqs 24-43, corrected): kStates orders times kOutputs rows, row
/// `order * kOutputs + output`, kStates columns. Units: the measurement's / s^order / the state's.
template <template <class> class System, class Scalar>
auto observability_matrix(const OperatingPoint<Scalar>& point) {
  using Sys = System<Scalar>;
  using Number = RunningError<Scalar>;
  constexpr int n = Sys::kStates;
  ObservabilityMatrix<Scalar, n * Sys::kOutputs, n> result;
  const Sys system(point);
  const auto x0 = Sys::state(point);
  const auto fill_order = [&]<int order>() {
    for (int output = 0; output < Sys::kOutputs; ++output) {
      for (int column = 0; column < n; ++column) {
        Dual<Number> x[static_cast<std::size_t>(n)];
        for (int i = 0; i < n; ++i) {
          x[i] = {Number(x0[i]), Number(i == column ? Scalar(1) : Scalar(0))};
        }
        const Dual<Number> u(Number(point.force_N), Number(0));
        const Dual<Number> u_rate(Number(point.force_rate_N_s), Number(0));
        result.replace(order * Sys::kOutputs + output, column,
                       lie_derivative<order>(system, output, x, u, u_rate).slope);
      }
    }
  };
  [&]<int... orders>(std::integer_sequence<int, orders...>) {
    (fill_order.template operator()<orders>(), ...);
  }
  (std::make_integer_sequence<int, n>{});
  return result;
}

/// O of stage 2 with the entries that eqs (38), (39) print.
template <class Scalar>
auto printed_friction_matrix(const OperatingPoint<Scalar>& at) {
  auto result = observability_matrix<FrictionSystem>(at);
  using Number = RunningError<Scalar>;
  const Number m = at.mass_kg, kv = at.friction_Ns_m, u = at.force_N, v = at.velocity_m_s;
  const Number order_1 = u / m, a = (u - kv * v) / m;
  result.replace(3, 2, order_1);  // order 1 of v
  result.replace(4, 2, order_1);  // order 2 of p is the same function
  result.replace(5, 2, Number(0) - kv / m * order_1 - a / m);
  return result;
}

/// O of stage 3 with the entry that eq (43) prints.
template <class Scalar>
auto printed_mass_matrix(const OperatingPoint<Scalar>& at) {
  auto result = observability_matrix<MassSystem>(at);
  const Scalar m = at.mass_kg;
  result.replace(5, 2, {result.O(5, 2) / (m * m), result.term_size(5, 2) / (m * m)});
  return result;
}

/// How observable a system is at a point.
template <class Scalar>
struct Observability {
  int states;  ///< n: observable if the rank equals it
  int rank;    ///< of O with rows and columns scaled to length 1; -1: O not finite
  Scalar smallest_singular_value;  ///< of O in SI units; 0 if the rank is short
  Scalar condition_number;         ///< largest / smallest singular value; infinity likewise
};

/// Rank, smallest singular value and condition number of an observability matrix in SI units. Rank
/// is independent of units, so it is computed after scaling rows and columns to comparable lengths;
/// a singular value within rounding counts as zero.
template <class Scalar, int rows, int n>
Observability<Scalar> judge_observability(const ObservabilityMatrix<Scalar, rows, n>& matrix) {
  constexpr Scalar infinity = std::numeric_limits<Scalar>::infinity();
  constexpr Scalar epsilon = std::numeric_limits<Scalar>::epsilon();
  if (!matrix.O.allFinite() || !matrix.term_size.allFinite()) return {n, -1, 0, infinity};

  // The error of each entry is a few epsilon of its terms' size.
  constexpr Scalar few_epsilon = Scalar(16) * epsilon;
  auto scaled = matrix.O;
  auto rounding = matrix.term_size;
  for (int i = 0; i < scaled.size(); ++i) {
    if (std::abs(scaled.data()[i]) <= few_epsilon * rounding.data()[i]) scaled.data()[i] = 0;
  }
  for (int pass = 0; pass < 8; ++pass) {
    for (int i = 0; i < rows; ++i) {
      const Scalar length = scaled.row(i).norm();
      if (!(length > 0)) continue;
      scaled.row(i) /= length;
      rounding.row(i) /= length;
    }
    for (int j = 0; j < n; ++j) {
      const Scalar length = scaled.col(j).norm();
      if (!(length > 0)) continue;
      scaled.col(j) /= length;
      rounding.col(j) /= length;
    }
  }
  const Scalar noise = few_epsilon * rounding.norm();
  const auto scaled_values = singular_values(scaled);
  int rank = 0;
  while (rank < n && scaled_values[rank] > noise) ++rank;
  if (rank < n) return {n, rank, 0, infinity};
  const auto values = singular_values(matrix.O);
  return {n, rank, values[n - 1], values[0] / values[n - 1]};
}

}  // namespace condyle
