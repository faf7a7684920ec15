// SPDX-License-Identifier: Apache-2.0
// Paths of a jaw's points in the planes of the head, as SVG in millimetres.
#pragma once

#include <array>
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

/// An area about a path, as its outline across and upward (mm).
struct DrawnBand {
  std::string kind;  ///< class
  std::vector<std::array<double, 2>> outline_mm;
};

/// One drawing.
struct PlaneDrawing {
  std::string title, x_label, y_label;
  /// incisor, condyle_left or condyle_right: name in the page's data; empty: it does not move.
  std::string point;
  const std::vector<Eigen::Vector3d>* path_m = nullptr;  ///< of a condyle
  int x = 0, y = 2;                                      ///< components drawn across and upward
  bool is_mirrored = false;                              ///< `x` grows to the left
  std::vector<DrawnAngle> angles;
  std::vector<DrawnBand> bands;
};

/// A path in one colour.
struct DrawnPath {
  std::string kind;                                    ///< class of its lines
  std::vector<std::vector<Eigen::Vector3d>> pieces_m;  ///< where samples are missing, none
};

/// `drawing` with `paths`, as an svg element; text is escaped.
std::string plane_svg(const PlaneDrawing& drawing, const std::vector<DrawnPath>& paths);

/// Three planes of the incisor or, not `named`, of point 1 in the instrument's frame.
std::vector<PlaneDrawing> incisor_drawings(bool named);
/// Two planes of each condyle, with the chords of its angles; none without landmarks.
std::vector<PlaneDrawing> condyle_drawings(const Analysis& analysis);

}  // namespace condyle::host
