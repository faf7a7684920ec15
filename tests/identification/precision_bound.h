// SPDX-License-Identifier: Apache-2.0
// How well friction and mass can be known at best from a regime's recording: the Cramer-Rao bound.
//
//   e = u - (m a + kv v + ks x + c)   what is left of the measured drive where a, v, x come from
//                                     measured positions: noise of spectrum S(w)
//   S(w)      s_u^2 T_u + |ks - m w^2 + i kv w|^2 s_z^2 T_z = |d0 + i d1 w - d2 w^2|^2
//   d2, d0    s_z sqrt(T_z) m, sqrt(s_u^2 T_u + s_z^2 T_z ks^2); d1 from the middle power of w
//   bound     inverse of the sum of squares of (a, v, x, 1), filtered by 1 / (d0 + d1 s + d2 s^2),
//             times T: the whitened columns of the Gauss-Markov estimate. Noise-free motion.
#pragma once

#include "identification/adversary.h"

namespace condyle::adversary {

struct PrecisionBound {
  double friction_Ns_m = 0, mass_kg = 0;  ///< standard deviations
};

PrecisionBound precision_bound(const Regime& regime, std::uint64_t seed);

}  // namespace condyle::adversary
