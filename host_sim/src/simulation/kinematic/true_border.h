// SPDX-License-Identifier: Apache-2.0
// True readings of border movements.
#pragma once

#include <string>
#include <vector>

#include "simulation/kinematic/true_measures.h"

namespace condyle::host {

struct TrueBorderValue {
  std::string reading;
  double value;
  const char* unit;
};

/// Those of the path `place_mm`, in A, during `span`.
std::vector<TrueBorderValue> true_border(const truth::PathFunction& place_mm,
                                         const truth::Span& span);

}  // namespace condyle::host
