// SPDX-License-Identifier: Apache-2.0
// Finds the coordinates of points among the channels of a stream.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "hosted/lsl/stream_info.h"

namespace condyle::host::lsl {

/// Channels of a point, or of a quaternion in the order w, x, y, z.
struct NamedGroup {
  std::string name;
  std::vector<std::size_t> channels;
};

/// Points and quaternions whose channels all have labels such as "x", "jaw_x", "jaw.Y", "posZ" and
/// "qw", "quat_x", or the types PositionX and OrientationW of XDF's conventions for motion capture.
struct NamedCoordinates {
  std::vector<NamedGroup> points, quaternions;
};
NamedCoordinates find_coordinates(const std::vector<StreamChannel>& channels);

/// The unit of a length in words ("mm", "millimeters", ...); empty if it is none.
std::string length_unit(const StreamChannel& channel);

}  // namespace condyle::host::lsl
