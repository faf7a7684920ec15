// SPDX-License-Identifier: Apache-2.0
// The devices of a session log: their reports, and what these mean.
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

  /// As the log has it.
  const hal::SessionSource& recorded() const { return reports->header().sources[index]; }
};

/// Opens the facebow of `log`, its first device. `profile`: a file used instead of the log's own;
/// may be empty. With a `clock`, reports come when their time has come (see SessionLogSource). An
/// InputError where log or profile cannot be used.
LogDevice open_log_facebow(const std::string& log, const std::string& profile = {},
                           hal::Clock* clock = nullptr);

/// Opens the first of the devices of `log` from number `first` on whose profile `is_wanted`; none
/// where there is no such device. `profile`: for the facebow, as above.
std::optional<LogDevice> open_log_device(
    const std::string& log, std::size_t first, const std::string& profile,
    const std::function<bool(const hal::DeviceProfile&)>& is_wanted);

}  // namespace condyle::host
