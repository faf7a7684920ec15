// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "comparison/compared_recording.h"
#include "output/output_file.h"

namespace condyle::host {

/// Evidence in `run` against its own intervals, in words; empty if there is none.
std::string warning_text(const RunReport& run);

/// The estimators on each recording in words.
std::string comparison_text(const std::vector<NamedEstimator>& estimators,
                            const std::vector<RecordingReport>& recordings);

/// One row for each recording and estimator, with all digits; an empty field is not known.
std::string comparison_csv(const std::vector<NamedEstimator>& estimators,
                           const std::vector<RecordingReport>& recordings);

/// Draws "estimators" into the folder `directory`: at most kMostDrawn recordings.
inline constexpr std::size_t kMostDrawn = 40;
std::vector<std::unique_ptr<OutputFile>> draw_comparison(
    const std::string& directory, const std::vector<NamedEstimator>& estimators,
    const std::vector<RecordingReport>& recordings);

}  // namespace condyle::host
