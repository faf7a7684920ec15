// SPDX-License-Identifier: Apache-2.0
// Checks that a device profile is usable.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "condyle/hal/hid/device_profile.h"
#include "condyle/hal/report/layout_check.h"

namespace condyle::hal {

/// Why a profile cannot be used.
struct ProfileProblem {
  ProfilePart part = ProfilePart::coordinates;
  std::size_t index = 0;
  std::string reason;  ///< "reaches beyond the report's 29 bytes"
  std::string mend;    ///< "raise minimum_size_bytes, or move the field"
};

/// The first problem of `profile`: one of its layout (find_layout_problem), or auxiliary fields
/// with the same name. With `descriptor_axes` set, what the descriptor is to supply is not checked:
/// the coordinates, and the minimum size if it is 0.
std::optional<ProfileProblem> find_problem(const DeviceProfile& profile);

/// The layout of `profile` for a decoder. If the profile is unusable, or the descriptor has not
/// supplied its coordinates yet, the layout is unusable too.
ReportLayout layout_of(const DeviceProfile& profile);

/// Name of coordinate `index` of a sample of `kind`: "x", "y2", "qw".
const char* coordinate_name(SampleKind kind, std::size_t index);

}  // namespace condyle::hal
