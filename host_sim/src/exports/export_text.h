// SPDX-License-Identifier: Apache-2.0
// Numbers and names in exported text.
#pragma once

#include <string>
#include <string_view>

#include "exports/computed_series.h"
#include "exports/export_data.h"

namespace condyle::host {

/// Appends `value * per_SI_unit` with the fewest digits that, divided by `per_SI_unit`, give
/// `value` again, to one unit of its last bit. `value` must be finite.
void append_scaled(std::string& text, double value, double per_SI_unit);

/// How values of `unit` are written where lengths are `units_per_metre`, and the unit's name.
struct WrittenUnit {
  double per_SI_unit = 1;
  std::string name;
};
WrittenUnit written_unit(const std::string& unit, double units_per_metre);

/// True of estimates, whose quantities all have one name.
inline bool has_several_quantities(const ExportSeries& series) {
  return series.name == kEstimateName && series.is_computed;
}
/// The name of a series that is not of points in space: "drive", "jaw_orientation",
/// "estimate_velocity".
std::string series_name(const ExportSeries& series);

/// A note that says what of `data` a format leaves out: what `is_held` does not hold. Empty if it
/// holds all.
std::string note_on_left_out(const ExportData& data, bool holds_channels, bool holds_events,
                             bool (*is_held)(const ExportSeries&));

}  // namespace condyle::host
