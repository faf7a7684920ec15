// SPDX-License-Identifier: Apache-2.0
// Even times, for formats that state one rate: the rate that the samples follow, or a new one.
#pragma once

#include <string>
#include <vector>

#include "exports/export_data.h"

namespace condyle::host {

/// The samples of a recording on even times.
struct EvenTimes {
  double rate_Hz = 0;
  std::vector<std::size_t> frame_of;  ///< the frame of each sample; rises
  std::size_t frames = 0;             ///< those without a sample included
  double largest_shift_s = 0;         ///< between the time of a sample and that of its frame
};

/// The even times that the samples of `data` follow. Steps of several frames are lost samples.
/// Throws an InputError that names the remedy if a sample lies more than a tenth of a step away, or
/// if there are few samples for very many frames.
EvenTimes even_times(const ExportData& data);

/// Adds to `notes` what `even` changes: empty frames, moved times, and the start if the format does
/// not keep it.
void note_even_times(const ExportData& data, const EvenTimes& even, bool keeps_start,
                     std::vector<std::string>& notes);

/// The samples of `data` at `rate_Hz` from the first sample on, by straight lines between
/// neighbours. A value that lies between two samples of which one is missing, or whose distance is
/// more than one and a half usual steps, is missing. Orientations turn evenly between neighbours.
/// Values become derived; events and channels stay as they are.
void resample(ExportData& data, double rate_Hz);

}  // namespace condyle::host
