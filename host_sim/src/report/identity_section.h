// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/report_section.h"

namespace condyle::host {

/// What was recorded, with which device, from which files; how it was read.
std::string identity_html(const ReportSection& section, const std::string& landmarks);

/// Tables behind it: files with their digests, landmarks, parameters of the estimates.
std::string identity_tables(const ReportSection& section, const std::string& prefix);

}  // namespace condyle::host
