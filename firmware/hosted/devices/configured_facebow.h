// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hosted/devices/log_replay_source.h"
#include "hosted/devices/session_device.h"
#include "hosted/devices/source_spec.h"
#include "hosted/devices/stream_spec.h"
#include "hosted/devices/synthetic_source.h"

namespace condyle::host {

/// A facebow that delivers its reports in real time, and their layout.
class ConfiguredFacebow {
 public:
  /// Reads the profile or the log's header; throws an InputError if that cannot be used. The device
  /// may still be absent. A session log is played at its recorded speed. `serial`: of a device;
  /// empty: any device. A simulated subject is refused, because it gives samples, not reports.
  ConfiguredFacebow(const SourceSpec& spec, const std::string& serial, hal::Clock& clock);
  /// A stream, which must be there; throws an InputError if it is not, or cannot be used.
  ConfiguredFacebow(const StreamSpec& stream, hal::Clock& clock);

  /// Looks for the device, completes the profile from its descriptor, and from then on accepts only
  /// its serial number. Throws an InputError if the device is absent or access is denied.
  void find(const std::function<bool()>& stop);

  /// Valid after find.
  hal::ReportSource& source();
  const hal::DeviceProfile& profile() const { return profile_; }
  const std::string& profile_text() const { return profile_text_; }
  const std::vector<std::uint8_t>& descriptor() const { return descriptor_; }
  /// The device or stream, or null for other sources.
  const SessionDevice* device() const { return device_.get(); }
  /// The synthetic facebow, or null for other sources.
  const SyntheticSource* synthetic() const { return synthetic_.get(); }

 private:
  hal::DeviceProfile profile_;
  std::string name_, profile_text_;
  std::vector<std::uint8_t> descriptor_;
  // Exactly one of these is set.
  std::unique_ptr<SessionDevice> device_;
  std::unique_ptr<LogReplaySource> log_;
  std::unique_ptr<SyntheticSource> synthetic_;
};

}  // namespace condyle::host
