// SPDX-License-Identifier: Apache-2.0
// The result of the search for tunings by the published criterion, as text, CSV and figure.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "output/output_file.h"
#include "tuning/published_criterion.h"

namespace condyle::host {

/// Indices of at most `most` of `result.tunings`, at least 2: those closest to evenly spaced
/// frictions, on a logarithmic scale, over the range found; lowest friction first.
std::vector<std::size_t> tunings_spread_evenly(const PublishedTuningResult& result,
                                               std::size_t most);

/// How many starts satisfied the criterion, some tunings in a table (the best, and others spread
/// over the frictions found), and the spread of their frictions; or that none did, and the closest
/// one.
std::string published_tuning_text(const PublishedTuningResult& result);

/// One row for each tuning that satisfies the criterion, smallest objective first, numbered from 1
/// as in the text; recordings are numbered in the order of `result.recordings`.
std::string published_tunings_csv(const PublishedTuningResult& result);

/// Draws friction and, below, mass over time, of the tunings that satisfy the criterion, for
/// `recording`, as published_tunings.svg and .png: twelve tunings at most, spread evenly over the
/// frictions found. None if none satisfies it. The files are closed but not committed. `name` is
/// the name of the recording in the title.
std::vector<std::unique_ptr<OutputFile>> draw_published_tunings(
    const std::string& directory, const std::string& name, const PublishedTuningResult& result,
    const PublishedRecording& recording);

}  // namespace condyle::host
