// SPDX-License-Identifier: Apache-2.0
// Live inspection of a device: properties of its reports, without or with a profile.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <map>
#include <optional>
#include <string>

#include "condyle/hal/hid/device_profile.h"
#include "condyle/hal/hid/report_descriptor.h"
#include "condyle/hal/report/device_facebow.h"
#include "inspect/byte_statistics.h"

namespace condyle::host {

/// Watches the reports that pass through it on their way from a source.
class DeviceInspector final : public hal::ReportSource {
 public:
  /// `descriptor`: nothing if the device's could not be decoded.
  DeviceInspector(hal::ReportSource& source, std::optional<hal::ReportDescriptor> descriptor)
      : source_(source), descriptor_(std::move(descriptor)) {}

  hal::Status open() override { return source_.open(); }
  hal::Status read(TimeNs deadline_ns, hal::RawReport& report) override;
  void close() override { source_.close(); }
  hal::TransportCounts counts() const override { return source_.counts(); }

  /// The reports so far, as text: for each report number the rate and its jitter, the last bytes,
  /// their values by the descriptor, the bytes that change and likely counters.
  std::string words() const;
  /// The same as JSON.
  nlohmann::ordered_json json() const;

 private:
  hal::ReportSource& source_;
  std::optional<hal::ReportDescriptor> descriptor_;
  std::map<std::uint8_t, ByteStatistics> watches_;  // by report id; 0: not numbered
};

/// The last report decoded by a profile, as text: millimetres, counter, losses, clock.
std::string profile_text(const hal::DeviceProfile& profile, const hal::DeviceFacebow& facebow);

}  // namespace condyle::host
