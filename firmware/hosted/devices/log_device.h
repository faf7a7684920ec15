// SPDX-License-Identifier: Apache-2.0
// The devices of a session log: their reports and profiles.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "condyle/hal/clock.h"
#include "condyle/hal/hid/device_profile.h"
#include "condyle/hal/log/session_log_source.h"

namespace condyle::host {

/// A device of a log.
struct LogDevice {
  std::size_t index = 0;                           ///< of the log's sources
  hal::DeviceProfile profile;                      ///< checked, complete
  std::unique_ptr<hal::SessionLogSource> reports;  ///< open

  /// As recorded in the log.
  const hal::SessionSource& recorded() const { return reports->header().sources[index]; }
};

/// Opens the facebow of `log`, its first device. `profile`: a file used instead of the log's own;
/// may be empty. With a `clock`, reports come at their recorded pace (see SessionLogSource). Throws
/// an InputError if log or profile cannot be used.
LogDevice open_log_facebow(const std::string& log, const std::string& profile = {},
                           hal::Clock* clock = nullptr);

/// Opens the first device of `log`, from number `first` on, whose profile satisfies `is_wanted`;
/// none if there is no such device. `profile`: for the facebow, as above.
std::optional<LogDevice> open_log_device(
    const std::string& log, std::size_t first, const std::string& profile,
    const std::function<bool(const hal::DeviceProfile&)>& is_wanted);

}  // namespace condyle::host
