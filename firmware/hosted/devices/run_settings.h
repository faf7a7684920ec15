// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "condyle/firmware/run_loop.h"
#include "condyle/hal/hid/device_profile.h"

namespace condyle::host {

/// How the run loop reads a device, and how it waits for one that went away.
inline firmware::RunSettings run_settings_of(const hal::DeviceProfile& profile,
                                             FollowedCoordinate followed) {
  firmware::RunSettings settings;
  settings.followed = followed;
  settings.nominal_step_ns = profile.nominal_step_ns().value_or(0);
  settings.expects_drive = profile.drive_N.has_value();
  settings.patience_ns = settings.reopen_pause_ns = 20'000'000;
  return settings;
}

}  // namespace condyle::host
