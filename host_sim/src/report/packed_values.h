// SPDX-License-Identifier: Apache-2.0
// Numbers in a report's page, packed as page/data.js reads them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace condyle::host {

/// base64 of the bytes of `values` as little-endian 32-bit floats.
std::string packed_times(const std::vector<double>& values);

/// {low, step, data}: values low + step k, k as base64 of little-endian 16-bit integers. The step
/// is 1/65,534 of the range, so a value is off by at most half of that. Not finite: none.
nlohmann::ordered_json packed_values(const std::vector<double>& values);

}  // namespace condyle::host
