// SPDX-License-Identifier: Apache-2.0
// The readings of one stroke: an excursion of the jaw from the reference position and back.
#pragma once

#include <string>
#include <vector>

#include "readings/reading.h"
#include "readings/reading_geometry.h"
#include "readings/reading_values.h"

namespace condyle::host {

/// What a stroke of `kind` has.
std::vector<StrokeReading> readings_of_stroke(TaskKind kind, bool has_landmarks);
std::vector<std::string_view> names_of(const std::vector<StrokeReading>& readings);

/// Their values for the path of one stroke, in their units; NaN where there is none. `why`, if not
/// null, then holds the reason. `turning_sd_rad_s`: noise of the path's rate of turning. After them
/// come separations (condyle_readings.h), doubts of arc lengths (smoothness.h) and shortfalls.
void read_stroke(TaskKind kind, bool has_landmarks, const JawPath& path,
                 std::vector<double>& values, std::vector<std::string>* why,
                 double turning_sd_rad_s = 0);

/// Of lengths, hulls and spreads, named in `names`: noise adds to them what its variance decides,
/// so that little of the correction is uncertain. A spread of axes takes in the error of the
/// method.
void narrow_what_noise_adds(const std::vector<StrokeReading>& names,
                            std::vector<UncertainValue>& values);

/// Of the direction of a working condyle's shift: its interval becomes that of the smallest shift
/// within the shift's own interval, of which it is missing if that contains none. Otherwise errors
/// that make a small shift seem large would also make its direction seem known.
void widen_shift_angle(const std::vector<StrokeReading>& names,
                       std::vector<UncertainValue>& values);

}  // namespace condyle::host
