// SPDX-License-Identifier: Apache-2.0
// Friction and mass from a measured drive, beside what was assumed before.
#pragma once

#include <string>

#include "report/report_section.h"

namespace condyle::host {

/// A table and a ruler for each value that a drive may determine, as HTML; empty without a drive.
/// `prefix` begins the name of the saved table.
std::string impedance_html(const ReportSection& section, const std::string& prefix);

}  // namespace condyle::host
