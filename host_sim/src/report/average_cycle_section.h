// SPDX-License-Identifier: Apache-2.0
// The average chewing cycle, with its band.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "readings/analysis.h"

namespace condyle::host {

/// Drawings and a table, or why there is no average, as HTML; empty without cycles. `prefix` begins
/// the name of the saved table.
std::string average_cycle_html(const Analysis& analysis, const std::string& prefix);

/// The averages as data.
nlohmann::ordered_json average_cycle_json(const Analysis& analysis);

}  // namespace condyle::host
