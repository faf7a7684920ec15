// SPDX-License-Identifier: Apache-2.0
// On a PC: the cases of filter_cases.h in both precisions, and their samples made beforehand.
#pragma once

#include <string>
#include <vector>

#include "bench/filter_cases.h"

namespace condyle::bench {

/// Positions (m) of a chewing jaw, and the time from the sample before (s).
template <class Scalar>
struct Recording {
  explicit Recording(std::size_t samples) {
    ChewingJaw jaw;
    for (std::size_t i = 0; i < samples; ++i) {
      const auto next = jaw.next<Scalar>();
      positions_m.push_back(next.position_m);
      steps_s.push_back(next.step_s);
    }
  }
  std::vector<Scalar> positions_m, steps_s;
};

/// Calls `visit.operator()<Case>(name)` for each case, `name` with its scalar type.
template <class Visitor>
void for_each_case(Visitor&& visit) {
  const auto in = [&visit]<class Scalar>(const char* scalar) {
    const auto named = [&visit, scalar]<class Case>(const char* name) {
      visit.template operator()<Case>(std::string(name) + "_" + scalar);
    };
    for_each_filter<Scalar>(named);
    for_each_dense_twin<Scalar>(named);
  };
  in.template operator()<double>("double");
  in.template operator()<float>("float");
}

}  // namespace condyle::bench
