// SPDX-License-Identifier: Apache-2.0
// The report as one HTML file that needs nothing else.
#pragma once

#include <string>
#include <vector>

#include "report/report_section.h"
#include "report/session_overlay.h"

namespace condyle::host {

/// The whole page. `landmarks`: name of their file, or empty. `overlay`: of the sections'
/// sessions, or null.
std::string report_page(const std::vector<ReportSection>& sections, const std::string& landmarks,
                        const SessionOverlay* overlay);

/// The data of the page's script: every reading as `condyle analyse --json` gives it, and the
/// packed curves and the comparison of sessions. Its text cannot end a script element.
std::string report_data(const std::vector<ReportSection>& sections, const SessionOverlay* overlay);

}  // namespace condyle::host
