// SPDX-License-Identifier: Apache-2.0
// The axes about which the jaw turns in an opening, by where they cross the midsagittal plane,
// forward of the condylar axis and above it.
//
//   hinge axis           least squares over the first 12 deg (path_measures.h)
//   helical axis         finite, from the reference position to the greatest rotation
//   finite axes          of four steps of equal rotation between these; each at least 5 deg,
//   because
//                        an axis is uncertain by the noise over the angle (Woltring et al. 1985)
//   instantaneous axes   on the way out where the jaw turns faster than half of its peak rate; mean
//                        weighted with the rate (Ancillao et al. 2022). Withheld if half of the
//                        peak is below 10 sd of the rate
// Their spread is the root of the mean squared distance from the mean.
#pragma once

#include <vector>

#include "readings/reading_geometry.h"
#include "readings/reading_values.h"

namespace condyle::host {

/// Their names, and the readings in this order. `twists_rad`: rotations about the left-right axis,
/// `twist` the greatest; `turning_sd_rad_s`: of the smoothed rate.
void add_axis_names(std::vector<StrokeReading>& names);
void add_axes(const JawPath& path, const std::vector<double>& twists_rad, const Greatest& twist,
              double turning_sd_rad_s, ReadingValues& out);
/// Says of instantaneous axes without a value that they exist and are not known: slow openings have
/// no value, and a mean of the fast ones would not be that of all.
void hide_unknown_axes(const std::vector<StrokeReading>& names,
                       std::vector<UncertainValue>& values);

}  // namespace condyle::host
