// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "output/figure_data.h"
#include "output/output_file.h"

namespace condyle::host {

/// Draws position, velocity, force, friction and mass over time, each as SVG and PNG, into the
/// folder `directory` with gnuplot. Assumed values are drawn dashed grey over hatching, with a
/// label; a quantity without values has no figure. The files are closed but not committed.
std::vector<std::unique_ptr<OutputFile>> draw_figures(const std::string& directory,
                                                      const std::string& title,
                                                      const FigureData& data);

}  // namespace condyle::host
