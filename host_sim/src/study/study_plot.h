// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "study/study_tables.h"

namespace condyle::host {

/// More subjects than these are drawn as boxes: lines would cover each other, and the page would
/// grow with the study.
constexpr std::size_t kMostSubjectsDrawn = 100;

/// A figure of one reading: the subjects' means in each session, as SVG in HTML.
std::string study_plot(const std::string& title, const std::string& unit,
                       const std::vector<StudySession>& sessions);

}  // namespace condyle::host
