// SPDX-License-Identifier: Apache-2.0
// Two or more sessions of one subject over each other, with the smallest detectable changes.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "comparison/session_comparison.h"
#include "report/report_section.h"

namespace condyle::host {

/// The sessions and what changed from one to the other.
struct SessionOverlay {
  std::vector<Session> sessions;
  SessionComparison motion;    ///< of the estimates, as `condyle compare` gives it
  SessionComparison readings;  ///< of the means of tasks; names: task, reading and side
};

/// Compares `sessions`, whose recordings are those of `sections`, in order. Throws InputError if
/// they cannot be compared.
SessionOverlay overlay_of(std::vector<Session> sessions,
                          const std::vector<ReportSection>& sections);

/// As HTML.
std::string overlay_html(const SessionOverlay& overlay, const std::vector<ReportSection>& sections);

/// The comparisons as data.
nlohmann::ordered_json overlay_json(const SessionOverlay& overlay);

}  // namespace condyle::host
