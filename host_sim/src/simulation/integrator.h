// SPDX-License-Identifier: Apache-2.0
// The classical Runge-Kutta step of order 4 (Kutta 1901), of fixed size and without a heap.
//
//   k1 = f(t, x), k2 = f(t + h/2, x + h/2 k1), k3 = f(t + h/2, x + h/2 k2), k4 = f(t + h, x + h k3)
//   x <- x + h/6 (k1 + 2 k2 + 2 k3 + k4)
//
// Stable for a rate -lambda only while lambda h < 2.78.
#pragma once

#include <array>
#include <cstddef>

namespace condyle::host {

/// Advances `x` from `time_s` by `step_s`. `f(time_s, x, dxdt)` writes the derivative of `x` (per
/// second) into `dxdt`.
template <std::size_t n, class Derivative>
void runge_kutta_4_step(std::array<double, n>& x, double time_s, double step_s,
                        const Derivative& f) {
  using State = std::array<double, n>;
  const auto moved = [&x](double duration_s, const State& rate) {
    State result;
    for (std::size_t i = 0; i < n; ++i) result[i] = x[i] + duration_s * rate[i];
    return result;
  };
  const double half_s = step_s / 2;
  State k1 = {}, k2 = {}, k3 = {}, k4 = {};
  f(time_s, x, k1);
  f(time_s + half_s, moved(half_s, k1), k2);
  f(time_s + half_s, moved(half_s, k2), k3);
  f(time_s + step_s, moved(step_s, k3), k4);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] += step_s / 6 * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]);
  }
}

}  // namespace condyle::host
