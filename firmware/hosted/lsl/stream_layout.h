// SPDX-License-Identifier: Apache-2.0
// Which channels of a stream are the jaw's position, and how a sample of the stream becomes a
// report:
//
//   bytes 0-3     count of samples of this connection, from 0
//   bytes 4-11    stamp of the sender's clock, float64 seconds, as sent or deduced
//   bytes 12-19   offset that was added to it, float64 seconds
//   bytes 20-27   arrival on this machine's clock, float64 seconds
//   bytes 28-     values of the stored channels, as sent, little-endian
//
// The report's time is stamp plus offset.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hosted/lsl/stream_info.h"

namespace condyle::host::lsl {

/// Bytes of a report before its values.
inline constexpr std::size_t kReportHead = 28;

/// What the user says about a stream.
struct StreamChoice {
  /// Labels, or numbers from 1: 1 (an axis), 3 (a point), 7 (point, then quaternion w x y z) or 9
  /// (three points) of them. Empty: found by their labels.
  std::vector<std::string> channels;
  std::string unit;  ///< "m", "cm", "mm" or "um"; empty: as the stream says
};

/// The channels in "jaw_x, jaw_y, 7".
std::vector<std::string> split_channels(const std::string& text);

/// How the samples of a stream are stored and read.
struct StreamLayout {
  std::string profile_toml;         ///< of the reports
  std::vector<std::size_t> stored;  ///< channels, in the order of the report
};

/// Throws an InputError, which begins with `where`, if channels or unit are not clear.
StreamLayout layout_of_stream(const StreamInfo& info, const StreamChoice& choice,
                              const std::string& where);

}  // namespace condyle::host::lsl
