// SPDX-License-Identifier: Apache-2.0
// Nonlinear observability of the paper's systems, eqs (24)-(43).
//
//   x        state;  f  dynamics x' = f(x, u);  y  measurements: the first states of x
//   u, u'    input and its rate of change; u'' = 0
//   L_k      Lie derivative of order k, the k-th time derivative of y:
//            L_0 = y,  L_k = (dL_{k-1}/dx) f + (dL_{k-1}/du) u'
//   O        observability matrix: the gradients dL_k/dx, k = 0 ... n-1, one below the other
//
// A system with n states is locally observable at (x, u, u') where O has rank n. Lie derivatives
// and gradients come from nested automatic differentiation of f (dual.h), none is written by hand.
//
// Where the printed matrix differs from the right one, it is kept beside it, to show both:
//   (24)        k_s' = 0 in a system whose equations hold k_v: k_s is then a state that enters no
//               equation. Right: k_v' = 0.
//   (29)        the derivative of a row vector, which has no value. Right: (0 1 0 0).
//   (38), (39)  friction column u/m at order 1 and, following from it, -(kv/m) u/m - a/m at
//   order 2.
//               Right: -v/m and (2 kv v - u)/m^2.
//   (43)        mass column at order 2 over m^4. Right: over m^2 (2 kv a / m^2 for constant u).
#pragma once

#include <Eigen/QR>
#include <Eigen/SVD>
#include <limits>
#include <utility>

#include "condyle/estimator/arithmetic.h"
#include "condyle/estimator/dual.h"

namespace condyle {

/// A point at which observability is judged, SI units. A system reads the fields its model names.
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

/// Builds O of `System` at `point` (eqs 24-43, corrected): kStates orders times kOutputs rows, row
/// `order * kOutputs + output`, kStates columns. Units: the measurement's / s^order / the state's.
template <template <class> class System, class Scalar>
auto observability_matrix(const OperatingPoint<Scalar>& point) {
  using Sys = System<Scalar>;
  constexpr int n = Sys::kStates;
  Eigen::Matrix<Scalar, n * Sys::kOutputs, n> O;
  const Sys system(point);
  const auto x0 = Sys::state(point);
  const auto fill_order = [&]<int order>() {
    for (int output = 0; output < Sys::kOutputs; ++output) {
      for (int column = 0; column < n; ++column) {
        Dual<Scalar> x[static_cast<std::size_t>(n)];
        for (int i = 0; i < n; ++i) x[i] = {x0[i], i == column ? Scalar(1) : Scalar(0)};
        O(order * Sys::kOutputs + output, column) =
            lie_derivative<order>(system, output, x, Dual<Scalar>(point.force_N, Scalar(0)),
                                  Dual<Scalar>(point.force_rate_N_s, Scalar(0)))
                .slope;
      }
    }
  };
  [&]<int... orders>(std::integer_sequence<int, orders...>) {
    (fill_order.template operator()<orders>(), ...);
  }
  (std::make_integer_sequence<int, n>{});
  return O;
}

/// O of stage 2 with the entries that eqs (38), (39) print.
template <class Scalar>
Eigen::Matrix<Scalar, 6, 3> printed_friction_matrix(const OperatingPoint<Scalar>& at) {
  auto O = observability_matrix<FrictionSystem>(at);
  const Scalar m = at.mass_kg, printed_order_1 = at.force_N / m;
  O(3, 2) = printed_order_1;  // order 1 of v
  O(4, 2) = printed_order_1;  // order 2 of p is the same function
  O(5, 2) = -(at.friction_Ns_m / m) * printed_order_1 - at.acceleration_m_s2() / m;
  return O;
}

/// O of stage 3 with the entry that eq (43) prints.
template <class Scalar>
Eigen::Matrix<Scalar, 6, 3> printed_mass_matrix(const OperatingPoint<Scalar>& at) {
  auto O = observability_matrix<MassSystem>(at);
  O(5, 2) /= at.mass_kg * at.mass_kg;  // order 2 of v
  return O;
}

/// How observable a system is at a point.
template <class Scalar>
struct Observability {
  int states;                      ///< n: observable where the rank equals it
  int rank;                        ///< of O with rows and columns brought to length 1
  Scalar smallest_singular_value;  ///< of O in SI units; 0 where the rank is short
  Scalar condition_number;         ///< largest / smallest singular value; infinity likewise
};

/// Rank, smallest singular value and condition number of an observability matrix in SI units. Rank
/// is independent of units, so it is taken after scaling rows and columns to comparable lengths.
template <class Derived>
auto judge_observability(const Eigen::MatrixBase<Derived>& matrix) {
  using Scalar = typename Derived::Scalar;
  using Plain = typename Derived::PlainObject;
  const Eigen::JacobiSVD<Plain> svd(matrix);
  const auto values = svd.singularValues();

  Plain scaled = matrix;
  for (int pass = 0; pass < 8; ++pass) {
    for (int i = 0; i < scaled.rows(); ++i) {
      const Scalar length = scaled.row(i).norm();
      if (length > 0) scaled.row(i) /= length;
    }
    for (int j = 0; j < scaled.cols(); ++j) {
      const Scalar length = scaled.col(j).norm();
      if (length > 0) scaled.col(j) /= length;
    }
  }
  Eigen::JacobiSVD<Plain> scaled_svd(scaled);
  scaled_svd.setThreshold(Scalar(1000) * std::numeric_limits<Scalar>::epsilon());
  const int n = static_cast<int>(matrix.cols());
  const int rank = static_cast<int>(scaled_svd.rank());
  const Scalar smallest = rank == n ? values[n - 1] : Scalar(0);
  return Observability<Scalar>{
      n, rank, smallest,
      rank == n ? values[0] / smallest : std::numeric_limits<Scalar>::infinity()};
}

}  // namespace condyle
