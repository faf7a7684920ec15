// SPDX-License-Identifier: Apache-2.0
// The files of an analysis.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "output/output_file.h"
#include "readings/analysis.h"

namespace condyle::host {

/// readings.csv of all recordings: one row for each reading.
std::string readings_csv(const std::vector<Analysis>& analyses);
/// readings.json: the same, with what they rest on.
std::string readings_json(const std::vector<Analysis>& analyses);
/// cycles.csv: one row for each cycle, those that are not taken with the reason.
std::string cycles_csv(const std::vector<Analysis>& analyses);
/// average_cycle.csv: a row for each point of each average, or the reason why there is none.
std::string average_cycle_csv(const std::vector<Analysis>& analyses);
/// poses.csv of one recording: a row for each usable sample.
void write_poses(const Analysis& analysis, OutputFile& file);

/// What a person reads first: usable or not, what was measured, what was withheld.
std::string analysis_text(const Analysis& analysis);

/// Of a summary: how many samples, and why some were not used.
std::string samples_text(const PoseCounts& counts);
/// Of a summary: noise of the instrument's positions and turns.
std::string noise_text(const Analysis& analysis);

/// Commands that draw the average cycles in the frontal plane and over time; empty: there are none.
std::string average_cycle_plot(const Analysis& analysis);

/// Draws the figures of `analysis` into `directory`, names beginning with `prefix`.
std::vector<std::unique_ptr<OutputFile>> draw_readings(const std::string& directory,
                                                       const std::string& prefix,
                                                       const Analysis& analysis);

}  // namespace condyle::host
