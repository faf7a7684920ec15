// SPDX-License-Identifier: Apache-2.0
// Whether repeats that follow each other are more alike than chance makes them. Where they are, the
// scatter within a session understates what differs between sessions.
//
//   x_ij   value of recording j of session i, in the order recorded
//   D      sum over i and j of (x_i,j+1 - x_ij)^2 (J. von Neumann, Ann. Math. Stat. 12 (1941) 367)
//
// Without such likeness every order within a session is as probable: the probability is the share
// of orders whose D is at most the observed one. All are tried where there are few, else kDrawn.
#pragma once

#include <cstddef>
#include <vector>

namespace condyle::host {

/// Orders drawn if there are more; fixed seed.
inline constexpr std::size_t kDrawnOrders = 2000;

/// That probability; 1 if no session has three values. A session of three or four alone cannot
/// make it small.
double probability_of_order(const std::vector<std::vector<double>>& sessions);

}  // namespace condyle::host
