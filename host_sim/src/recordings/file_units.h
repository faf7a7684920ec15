// SPDX-License-Identifier: Apache-2.0
// Units as files spell them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "recordings/recording.h"

namespace condyle::host {

/// A unit of length.
struct LengthUnit {
  std::string name;  ///< "mm", "cm", "m", "um", "in"
  double per_metre = 1;
};

/// Takes the unit of --unit, if one is given, as the unit of `info`; a note says so if the file
/// states another one.
void use_given_unit(std::optional<double> given_per_metre, RecordingInfo& info);

/// The unit of length that `text` spells: "mm", "meters", "Metres", "mete" of a cut field. None for
/// other texts.
std::optional<LengthUnit> length_unit(std::string_view text);

/// How many newtons the unit of force is that `text` spells: "N", "kN", "nt", "Newtons". None for
/// other texts.
std::optional<double> newtons_in(std::string_view text);

}  // namespace condyle::host
