// SPDX-License-Identifier: Apache-2.0
// The shape of a chewing cycle, between its closed instants and its greatest opening.
//
//   z, y, x   height, left and forward of the incisor (m), cubics between samples
//   H         height of the closing path, from the greatest opening to the closed end
//   occlusal time   from the last passage upward of 0.5 mm below the closed end to the next
//   downward slow close      from when the closing speed falls below half of its peak, to the
//   closed end closing path    from 0.2 H to 0.8 H area            1/2 integral (a dz - z da), a: y
//   or x; closed by the line from end to begin.
//                   Positive: the closing path lies left (y) or in front (x) of the opening path
//   closing side    mean y of the closing path over its heights, less the mean y of begin and end
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "readings/path_measures.h"
#include "readings/reading_geometry.h"

namespace condyle::host {

/// A cycle on a path: samples, and times between samples.
struct CycleMarks {
  std::size_t begin = 0, turn = 0, end = 0;
  double begin_s = 0, end_s = 0;
  bool ends_with_pause = false;
};

/// Integrals over a cycle, by Simpson's rule on cubics: length of the path, and twice the areas
/// that the rays from the origin sweep in the frontal and in the sagittal plane.
struct CycleIntegrals {
  double length_m = 0, frontal_m2 = 0, sagittal_m2 = 0;
};
CycleIntegrals integrals_of(const CycleMarks& cycle, const JawPath& path);

/// Names of the readings of the shape that need no landmarks, and of those that do.
std::vector<std::string_view> names_of_cycle_shape();
std::vector<std::string_view> names_of_cycle_shape_with_landmarks();

/// Appends them to `values`, in this order, and to `why` unless it is null; `rates_m_s`: of the
/// heights, `greatest`: as read_cycle has it. A value that cannot be computed is NaN.
void add_cycle_shape(const CycleMarks& cycle, const JawPath& path, const CycleIntegrals& integrals,
                     const std::vector<double>& heights_m, const std::vector<double>& rates_m_s,
                     const GreatestAt& greatest, std::vector<double>& values,
                     std::vector<std::string>* why);
void add_cycle_shape_with_landmarks(const CycleMarks& cycle, const JawPath& path,
                                    const CycleIntegrals& integrals, const GreatestAt& greatest,
                                    std::vector<double>& values, std::vector<std::string>* why);

/// What only decides on the side and on the direction of the loop: closing side (mm), area of the
/// frontal and of the sagittal loop with its sign (mm2).
inline constexpr std::size_t kCycleDirections = 3;

}  // namespace condyle::host
