// SPDX-License-Identifier: Apache-2.0
// The group level of a study: what the recordings show together.
#pragma once

#include <string>
#include <vector>

#include "study/study_tables.h"

namespace condyle::host {

/// Writes into OUT/group: readings.csv (all rows), problems.csv, repeatability.csv, changes.csv and
/// study.html. Returns what a person reads of it. Throws InputError.
std::string run_group_level(const std::string& out, const std::vector<StudyRecording>& recordings);

/// The page of the study, for any browser, without a network.
std::string study_page(const StudyTables& tables);

/// A reading's name with its task and side, for people.
std::string reading_title(const ReadingKey& key);

/// The standard deviation of the scatter and the smallest detectable change of one recording to
/// another; empty if it is not known.
std::string scatter_text(const Repeatability& scatter, const std::string& unit);

}  // namespace condyle::host
