// SPDX-License-Identifier: Apache-2.0
// Whether successive repeats are more alike than by chance. If so, the scatter within a session
// understates the scatter between sessions.
//
//   x_ij   value of recording j of session i, in the order recorded
//   D      sum over i and j of (x_i,j+1 - x_ij)^2 (J. von Neumann, Ann. Math. Stat. 12 (1941) 367)
//
// Without such likeness all orders within a session are equally probable: the probability is the
// share of orders whose D is at most the observed one. All orders are tried if there are at most
// kDrawn, otherwise kDrawn random ones.
#pragma once

#include <cstddef>
#include <vector>

namespace condyle::host {

/// Number of random orders, if there are more; fixed seed.
inline constexpr std::size_t kDrawnOrders = 2000;

/// This probability; 1 if no session has three values. A single session of three or four cannot
/// make it small.
double probability_of_order(const std::vector<std::vector<double>>& sessions);

}  // namespace condyle::host
