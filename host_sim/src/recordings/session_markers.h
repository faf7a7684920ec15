// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "condyle/estimator/sample.h"

namespace condyle::host {

/// A marker of a recorded session.
struct SessionMarker {
  TimeNs time_ns = 0;  ///< on the clock of the reports
  std::string text;
};

/// The markers of a session log, as far as it can be read.
std::vector<SessionMarker> read_markers(const std::string& log);

/// One line for each, at most twenty, for the user.
std::vector<std::string> marker_notes(const std::vector<SessionMarker>& markers);

/// The same as CSV: time_s,text.
std::string markers_csv(const std::vector<SessionMarker>& markers);

}  // namespace condyle::host
