// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hosted/devices/played_log.h"
#include "hosted/devices/session_device.h"
#include "hosted/devices/source_spec.h"
#include "hosted/devices/synthetic_source.h"

namespace condyle::host {

/// A facebow that gives its reports as time passes, and what they mean.
class FacebowReports {
 public:
  /// Reads the profile or the log's header; an InputError where that cannot be used. A device need
  /// not be there yet. A session log is played at the speed it was recorded with. `serial`: of a
  /// device; empty: any. Of no simulated subject: that gives samples, not reports.
  FacebowReports(const SourceSpec& spec, const std::string& serial, hal::Clock& clock);

  /// Looks for the device, completes the profile from its descriptor, and keeps to its serial
  /// number from here on. An InputError where it is not there or may not be opened.
  void find(const std::function<bool()>& stop);

  /// After find.
  hal::ReportSource& source();
  const hal::DeviceProfile& profile() const { return profile_; }
  const std::string& profile_text() const { return profile_text_; }
  const std::vector<std::uint8_t>& descriptor() const { return descriptor_; }
  /// Where it is a device; else null.
  const SessionDevice* device() const { return device_.get(); }
  /// Of a made-up facebow; null of any other.
  const SyntheticSource* synthetic() const { return synthetic_.get(); }

 private:
  hal::DeviceProfile profile_;
  std::string name_, profile_text_;
  std::vector<std::uint8_t> descriptor_;
  // One of these.
  std::unique_ptr<SessionDevice> device_;
  std::unique_ptr<PlayedLog> log_;
  std::unique_ptr<SyntheticSource> synthetic_;
};

}  // namespace condyle::host
