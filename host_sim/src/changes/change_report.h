// SPDX-License-Identifier: Apache-2.0
// The result of the change detector, as text, CSV and figure.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "changes/change_watch.h"
#include "output/output_file.h"

namespace condyle::host {

/// Cycles, changes if any, and the smallest change that could have been detected.
std::string changes_text(const ChangeWatch& watch, const WatchSettings& settings);

/// One row for each cycle that ended, counted or not; cycles are numbered from 1.
std::string changes_csv(const ChangeWatch& watch);

/// Draws each cycle's damping with its standard deviation, and the statistics against the threshold
/// below, as changes.svg and changes.png. The files are closed but not committed. `name`: of the
/// recording.
std::vector<std::unique_ptr<OutputFile>> draw_changes(const std::string& directory,
                                                      const std::string& name,
                                                      const ChangeWatch& watch);

}  // namespace condyle::host
