// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace condyle::host {

/// Colours that distinguish estimators or sessions; they repeat in this order.
inline constexpr const char* kSeriesColours[] = {"#0b559f", "#b35900", "#2e7d32",
                                                 "#6a3d9a", "#606060", "#a0226f"};
inline constexpr std::size_t kSeriesColourCount = 6;

/// `text` cut in its middle to at most `longest` characters, so that start and end stay visible.
/// UTF-8 characters stay whole.
std::string figure_label(const std::string& text, std::size_t longest);

}  // namespace condyle::host
