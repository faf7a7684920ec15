// SPDX-License-Identifier: Apache-2.0
#include "hosted/devices/log_device.h"

#include "hosted/config/device_profile_file.h"
#include "hosted/devices/device_text.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

std::unique_ptr<hal::SessionLogSource> open_reports(const std::string& log, std::size_t index,
                                                    hal::Clock* clock) {
  auto reports = std::make_unique<hal::SessionLogSource>(log, index, clock);
  const hal::Status status = reports->open();
  if (status == hal::Status::ok) return reports;
  const std::string problem = reports->problem();
  throw InputError(log, problem.empty() ? hal::status_name(status) : problem, "name a session log");
}

// Uses the log's own profile, or the one in the file `profile`; neither checked nor completed.
LogDevice open_device(const std::string& log, std::size_t index, const std::string& profile,
                      hal::Clock* clock) {
  LogDevice device;
  device.index = index;
  device.reports = open_reports(log, index, clock);
  const hal::SessionSource& recorded = device.recorded();
  if (!hal::is_device(recorded)) return device;
  const std::string owner = index == 0 ? "its profile" : "the profile of " + recorded.name;
  device.profile = profile.empty() ? parse_device_profile(log + ": " + owner, recorded.profile_toml)
                                   : load_device_profile(profile);
  return device;
}

}  // namespace

LogDevice open_log_facebow(const std::string& log, const std::string& profile, hal::Clock* clock) {
  LogDevice device = open_device(log, 0, profile, clock);
  require_position(device.profile, profile.empty() ? log + ": its profile" : profile);
  complete_profile(device.profile, device.recorded().report_descriptor, log);
  return device;
}

std::optional<LogDevice> open_log_device(
    const std::string& log, std::size_t first, const std::string& profile,
    const std::function<bool(const hal::DeviceProfile&)>& is_wanted) {
  const std::size_t sources = open_reports(log, 0, nullptr)->header().sources.size();
  for (std::size_t i = first; i < sources; ++i) {
    LogDevice device = open_device(log, i, i == 0 ? profile : "", nullptr);
    if (!hal::is_device(device.recorded()) || !is_wanted(device.profile)) continue;
    complete_profile(device.profile, device.recorded().report_descriptor, log);
    return device;
  }
  return std::nullopt;
}

}  // namespace condyle::host
