// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "box/configuration.h"
#include "box/sources/played_log.h"
#include "box/sources/synthetic_source.h"
#include "hosted/devices/session_device.h"

namespace condyle::box {

/// The facebow that the configuration names, and what its reports mean.
class FacebowReports {
 public:
  /// Reads the profile or the log's header; an InputError where that cannot be used. Devices need
  /// not be there yet.
  FacebowReports(const SourceSettings& settings, hal::Clock& clock);

  /// Looks for the device, completes the profile from its descriptor, and keeps to its serial
  /// number from here on. An InputError where it is not there or may not be opened.
  void find(const std::function<bool()>& stop);

  /// After find.
  hal::ReportSource& source();
  const hal::DeviceProfile& profile() const { return profile_; }
  const std::string& profile_text() const { return profile_text_; }
  const std::vector<std::uint8_t>& descriptor() const { return descriptor_; }
  /// Where it is a device; else null.
  const host::SessionDevice* device() const { return device_.get(); }
  /// Of a synthetic facebow; null of any other.
  const SyntheticSource* synthetic() const { return synthetic_.get(); }

 private:
  hal::DeviceProfile profile_;
  std::string name_, profile_text_;
  std::vector<std::uint8_t> descriptor_;
  // One of these.
  std::unique_ptr<host::SessionDevice> device_;
  std::unique_ptr<PlayedLog> log_;
  std::unique_ptr<SyntheticSource> synthetic_;
};

}  // namespace condyle::box
