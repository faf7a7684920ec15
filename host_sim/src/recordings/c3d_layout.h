// SPDX-License-Identifier: Apache-2.0
// What the header and the parameters of a C3D file state, and where its frames are.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hosted/files/byte_reader.h"
#include "recordings/c3d_parameters.h"
#include "recordings/recording.h"

namespace condyle::host {

/// An analogue channel, and how its numbers become values: (number - offset) * scale.
struct C3dChannel {
  double offset = 0, scale = 1;
  bool is_scaled = true;  ///< the file states a scale
};

/// A C3D file before its frames.
struct C3dLayout {
  C3dProcessor processor = C3dProcessor::intel;
  bool has_floats = false;     ///< in the frames, otherwise 16-bit integers
  double scale = 1;            ///< of integer coordinates
  double units_per_metre = 1;  ///< of the coordinates
  bool is_unsigned = false;    ///< integers of the analogue channels
  std::size_t samples = 0;     ///< of each analogue channel in a frame
  double rate_Hz = 0;
  std::uint64_t frames = 0;
  std::vector<std::string> names;    ///< of the points
  std::vector<C3dChannel> channels;  ///< as in `stated.channels`
  FileStatement stated;
  std::string unit;  ///< of the points, as in the file
  std::vector<std::string> notes;

  std::size_t number_bytes() const { return has_floats ? 4 : 2; }
  /// Numbers in a frame: four of each point, then the samples of the channels.
  std::size_t numbers() const { return 4 * names.size() + samples * channels.size(); }
  std::size_t frame_bytes() const { return numbers() * number_bytes(); }
};

/// The number at `bytes` of a frame.
double c3d_number(const C3dLayout& layout, const char* bytes);
/// The coordinates of the point at `bytes` of a frame, in the file's unit; NaN if it was not
/// measured.
Eigen::Vector3d c3d_point(const C3dLayout& layout, const char* bytes);

/// Reads everything before the frames from `reader`, which then is at the first frame.
/// Throws InputError if the file cannot be read.
C3dLayout read_c3d_layout(ByteReader& reader);

/// Finds the unit of the points of `layout`, whose frames are next in `reader`, and notes in it
/// how. `given_per_metre`: as the user states it. Throws InputError if it is not known.
void find_c3d_unit(ByteReader& reader, std::optional<double> given_per_metre, C3dLayout& layout);

}  // namespace condyle::host
