// SPDX-License-Identifier: Apache-2.0
// What a watch for changes found, in words, as CSV and as a picture.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "changes/change_watch.h"
#include "output/output_file.h"

namespace condyle::host {

/// Cycles, changes or that none was found, and what could have been found.
std::string changes_text(const ChangeWatch& watch, const WatchSettings& settings);

/// A row per cycle that ended, counted or not; cycles are numbered from 1.
std::string changes_csv(const ChangeWatch& watch);

/// Draws each cycle's damping with its standard deviation, and the statistics against the threshold
/// below, as changes.svg and changes.png. The files are closed, and wait for `commit`. `name` is
/// the recording's.
std::vector<std::unique_ptr<OutputFile>> draw_changes(const std::string& directory,
                                                      const std::string& name,
                                                      const ChangeWatch& watch);

}  // namespace condyle::host
