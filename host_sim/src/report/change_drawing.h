// SPDX-License-Identifier: Apache-2.0
// One quantity in several sessions, as a drawing.
#pragma once

#include <string>

#include "comparison/session_comparison.h"

namespace condyle::host {

/// Colours and dashes of sessions in the page's style; more sessions repeat them.
inline constexpr std::size_t kSessionStyles = 4;

/// The recordings' values, the means and the smallest detectable change about the first mean, as an
/// svg element. `quantity` is compared.
std::string change_svg(const QuantityComparison& quantity);

}  // namespace condyle::host
