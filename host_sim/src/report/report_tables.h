// SPDX-License-Identifier: Apache-2.0
// The tables of a report, as HTML; text from files is escaped. `prefix` begins the names of saved
// tables.
#pragma once

#include <string>
#include <vector>

#include "report/report_section.h"

namespace condyle::host {

/// What the marks beside values mean.
std::string provenance_key();
/// The colours of tasks.
std::string task_key(const Analysis& analysis);
std::string tasks_table(const Analysis& analysis, const std::string& prefix);
/// Means of tasks.
std::string readings_table(const Analysis& analysis, const std::string& prefix);
/// Single strokes.
std::string strokes_table(const Analysis& analysis, const std::string& prefix);
std::string cycles_table(const Analysis& analysis, const std::string& prefix);
/// What is withheld, with its reason, which says what to record.
std::string withheld_table(const Analysis& analysis, const std::string& prefix);
/// The same in short, with a link to the table; empty if nothing is withheld.
std::string withheld_banner(const Analysis& analysis, const std::string& prefix);
/// Definitions of the readings that are shown.
std::string definitions_table(const std::vector<ReportSection>& sections);
/// `text` in several lines, escaped.
std::string html_lines(const std::string& text);

}  // namespace condyle::host
