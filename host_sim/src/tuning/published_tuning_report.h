// SPDX-License-Identifier: Apache-2.0
// What the search for tunings by the published criterion found, in words, as CSV and as a picture.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "output/output_file.h"
#include "tuning/published_criterion.h"

namespace condyle::host {

/// Indices of at most `most` of `result.tunings`, at least 2: those nearest to as many frictions
/// spread evenly, on a logarithmic scale, over the range found; lowest friction first.
std::vector<std::size_t> tunings_spread_evenly(const PublishedTuningResult& result,
                                               std::size_t most);

/// How many starts satisfied the criterion, some tunings in a table (the best, and others spread
/// over the frictions found), and how far their frictions lie apart; or that none did, and the
/// closest.
std::string published_tuning_text(const PublishedTuningResult& result);

/// A row per tuning that satisfies the criterion, smallest objective first and numbered from 1, as
/// in the text; recordings are numbered in the order of `result.recordings`.
std::string published_tunings_csv(const PublishedTuningResult& result);

/// Draws friction and, below, mass over time, as the tunings that satisfy the criterion have them
/// for `recording`, as published_tunings.svg and .png: twelve tunings at most, spread evenly over
/// the frictions found. None if none satisfies it. The files are closed, and wait for `commit`.
/// `name` is the recording's in the title.
std::vector<std::unique_ptr<OutputFile>> draw_published_tunings(
    const std::string& directory, const std::string& name, const PublishedTuningResult& result,
    const PublishedRecording& recording);

}  // namespace condyle::host
