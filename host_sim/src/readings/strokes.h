// SPDX-License-Identifier: Apache-2.0
// Where a recording rests, and where the jaw leaves the reference position and comes back.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "readings/reading.h"
#include "readings/reading_geometry.h"
#include "readings/sample_run.h"

namespace condyle::host {

/// The intervals of at least 0.3 s in which the middle of the points moves slower than 2 mm/s,
/// without their beginnings and ends.
std::vector<SampleRun> find_rests(const PoseTrack& track);

/// The longest interval of at least 0.3 s in which the middle of the points moves slower than
/// 2 mm/s, as samples; of those within 0.5 mm of the most closed such interval. `up`: direction of
/// closing in the instrument's frame; if it is not known, zero, and the first such interval counts.
/// Absent if there is none.
std::optional<SampleRun> find_rest(const PoseTrack& track, const Eigen::Vector3d& up);

/// Excursions of `distance_m`, which is that of the followed point from the reference position:
/// from the last sample near it to the next sample near it. An excursion is at least `least_m`
/// high.
std::vector<SampleRun> find_strokes(const std::vector<double>& distance_m, std::size_t begin,
                                    std::size_t end, double least_m);

/// The same, each excursion by itself: of at least `least_m`, whatever the others reach.
std::vector<SampleRun> find_strokes_alone(const std::vector<double>& distance_m, std::size_t begin,
                                          std::size_t end, double least_m);

/// The kind of task of a stroke whose incisor is displaced by `turn_m` in the head frame at its
/// greatest distance; absent if it is none of them.
std::optional<TaskKind> kind_of_stroke(const Eigen::Vector3d& turn_m);

/// The longest time between neighbouring samples from `begin` to `end` (without), s.
double longest_gap_s(const std::vector<double>& time_s, std::size_t begin, std::size_t end);

/// The longest gap between samples over which a drawn path goes on (s): 0.1 s, or 3.5 median steps
/// if they are longer.
double longest_drawn_gap_s(const std::vector<double>& time_s);
/// The samples of `run`, divided where the gap between two is longer than `gap_s`.
std::vector<SampleRun> runs_without_gap(const std::vector<double>& time_s, SampleRun run,
                                        double gap_s);

}  // namespace condyle::host
