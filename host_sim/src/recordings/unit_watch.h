// SPDX-License-Identifier: Apache-2.0
// Watches positions for a unit that cannot be right: a file may state mm and hold metres.
#pragma once

#include <memory>

#include "recordings/named_points.h"

namespace condyle::host {

/// What is done about positions that are a jaw's in another unit only.
enum class UnitDoubt {
  refuse,  ///< an InputError at the end of the recording
  note,    ///< a note at its end: the user has stated the unit, or only looks at the file
};

/// `recording`, whose positions are watched, in a unit that the file states or its format implies:
///
///   too small   all points stay within 10 mm of the origin, move smoothly, and never by more than
///               0.15 mm, but by 2 um at least: as metres they are a jaw's
///   too large   all points move by more than 5 m, and the file states metres: as millimetres they
///               are a jaw's
///
/// A note says so if all points move by more than 5 m in another unit, and, unless doubts are noted
/// only, if they move by 0.5 m to 5 m.
std::unique_ptr<Recording> watch_unit(std::unique_ptr<Recording> recording, UnitDoubt doubt,
                                      const std::string& path);

}  // namespace condyle::host
