// SPDX-License-Identifier: Apache-2.0
// Device profiles as TOML files. hal/profiles/condyle_facebow.toml documents the format.
#pragma once

#include <string>
#include <string_view>

#include "condyle/hal/hid/device_profile.h"

namespace condyle::host {

/// Reads the profile in a file; an InputError contains place, problem and remedy. The profile is
/// usable (hal::find_problem); with `descriptor_axes` set, only after hal::complete_from_descriptor
/// has found the coordinates.
hal::DeviceProfile load_device_profile(const std::string& path);

/// The same from `text`, which messages call `name`.
hal::DeviceProfile parse_device_profile(const std::string& name, std::string_view text);

}  // namespace condyle::host
