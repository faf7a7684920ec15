// SPDX-License-Identifier: Apache-2.0
// The condyles in a stroke. Travel: sqrt(x^2 + z^2) of a condyle, from the reference position.
//
// Separation at a travel s: s (b - a), a and b the inclinations atan2(-z, x) where the travel first
// reaches s on the way out, and falls below it on the way back. Positive: the way back is lower.
#pragma once

#include <string>
#include <vector>

#include "readings/reading_geometry.h"
#include "readings/reading_values.h"

namespace condyle::host {

/// Separations of the ways out and back at equal steps of travel (mm), left and right; NaN where
/// the condyle does not reach the travel on both ways.
struct CondylarSeparations {
  static constexpr std::size_t kPlaces = 8;
  using Side = std::array<double, kPlaces>;
  std::array<Side, 2> mm;
};

/// The names of their readings, and the readings in this order.
void add_condyle_names(TaskKind kind, std::vector<StrokeReading>& names);
CondylarSeparations add_condyles(TaskKind kind, const JawPath& path, ReadingValues& out);

/// Appends what only decides on crossings: for each condylar_crossing_count in turn the
/// separations, and how far the condyle ends from where it began (mm).
void add_separations(TaskKind kind, const JawPath& path, const CondylarSeparations& separations,
                     ReadingValues& out);
/// Counts the crossings from these, which follow the values of `names`, and removes them. The
/// interval of the condylar_separation_mm before each count takes in what the way back missed.
void finish_separations(const std::vector<StrokeReading>& names,
                        std::vector<UncertainValue>& values);

/// Withholds the condyles' readings among `values`, named in `names`, with the reason `why`.
void withhold_condyles(const std::vector<StrokeReading>& names, const std::string& why,
                       std::vector<UncertainValue>& values);

/// Medial of a condyle on `side` (0: left).
double medial(const Eigen::Vector3d& point, std::size_t side);

}  // namespace condyle::host
