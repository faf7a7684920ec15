// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "figure_data.h"

namespace condyle::host {

/// Draws position, velocity, force, friction and mass over time, each as SVG and PNG, into
/// `directory` (made where missing) with gnuplot. Values that are assumed are drawn dashed grey
/// over hatching and labelled so. Returns the files' paths. All of them appear, or none.
std::vector<std::string> draw_figures(const std::string& directory, const std::string& title,
                                      const FigureData& data);

}  // namespace condyle::host
