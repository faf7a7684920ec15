// SPDX-License-Identifier: Apache-2.0
// What makes a device profile usable.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "condyle/hal/device_profile.h"

namespace condyle::hal {

/// The part of a profile that a problem is in.
enum class ProfilePart : std::uint8_t {
  rate,
  minimum_size,
  coordinates,  ///< `index`: in DeviceProfile::coordinates, if it is in there
  device_time,
  sequence,
  checksum,
  drive,
  auxiliary,  ///< `index`: in DeviceProfile::auxiliary, if it is in there
};

/// Why a profile cannot be used.
struct ProfileProblem {
  ProfilePart part = ProfilePart::coordinates;
  std::size_t index = 0;
  std::string reason;  ///< "reaches beyond the report's 29 bytes"
  std::string mend;    ///< "raise minimum_size_bytes, or move the field"
};

/// The first problem of `profile`: a field outside the report or across another one, coordinates
/// missing or given twice, a scale of zero, ... A profile without any coordinate is one of another
/// instrument, which has a drive or auxiliary fields instead. With `descriptor_axes` set, what the
/// descriptor is to supply is not asked for: the coordinates, and the minimum size where it is 0.
std::optional<ProfileProblem> find_problem(const DeviceProfile& profile);

/// Name of coordinate `index` of a sample of `kind`: "x", "y2", "qw".
const char* coordinate_name(SampleKind kind, std::size_t index);

}  // namespace condyle::hal
