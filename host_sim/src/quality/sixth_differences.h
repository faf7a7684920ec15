// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace condyle::host {

/// Standard deviation of the white noise in at least 7 evenly spaced `values` of a slow motion,
/// from the median of their sixth differences, which cancel the motion; their variance is C(12, 6)
/// times that of the noise.
double noise_by_sixth_differences(std::vector<double> values);

}  // namespace condyle::host
