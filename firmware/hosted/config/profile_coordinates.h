// SPDX-License-Identifier: Apache-2.0
// The [coordinates] and [quaternion] sections of a device profile. Private to device_profile_file.
#pragma once

#include <string>
#include <vector>

#include "condyle/hal/hid/device_profile.h"
#include "hosted/config/profile_field_reader.h"
#include "hosted/files/toml_reader.h"

namespace condyle::host {

/// Section in which each of DeviceProfile::coordinates is given.
using CoordinateSections = std::vector<std::string>;

/// Reads kind and coordinates, or the axes for the report descriptor, into `profile`. `plain` holds
/// what all fields have in common.
CoordinateSections read_coordinates(TomlReader& file, ProfileFieldReader& fields,
                                    const FieldText& plain, hal::DeviceProfile& profile);

}  // namespace condyle::host
