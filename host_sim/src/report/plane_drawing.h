// SPDX-License-Identifier: Apache-2.0
// Paths of a jaw's points in the planes of the head, as SVG in millimetres.
#pragma once

#include <string>
#include <vector>

#include "readings/analysis.h"

namespace condyle::host {

/// A direction with its interval, drawn from the origin as a chord and a fan (deg, from the
/// horizontal axis, upward positive as drawn) up to `length_mm`.
struct DrawnAngle {
  std::string label;
  double length_mm = 0, value_deg = 0, low_deg = 0, high_deg = 0;
};

/// One drawing.
struct PlaneDrawing {
  std::string title, x_label, y_label;
  std::string point;  ///< incisor, condyle_left or condyle_right: name in the page's data
  const std::vector<Eigen::Vector3d>* path_m = nullptr;
  int x = 0, y = 2;          ///< components drawn across and upward
  bool is_mirrored = false;  /// < `x` grows to the left
  std::vector<DrawnAngle> angles;
};

/// The drawing of the tasks of `analysis`, as an svg element; text is escaped.
std::string plane_svg(const Analysis& analysis, const PlaneDrawing& drawing);

/// The drawings of `analysis`: the incisor in three planes, and the condyles in two.
std::vector<PlaneDrawing> incisor_drawings(const Analysis& analysis);
std::vector<PlaneDrawing> condyle_drawings(const Analysis& analysis);

}  // namespace condyle::host
