// SPDX-License-Identifier: Apache-2.0
// A device being looked at: all that its reports show, without or with a profile.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <map>
#include <optional>
#include <string>

#include "condyle/hal/hid/device_profile.h"
#include "condyle/hal/hid/report_descriptor.h"
#include "condyle/hal/report/device_facebow.h"
#include "inspect/report_watch.h"

namespace condyle::host {

/// Watches the reports that pass through it on their way from a source.
class LiveInspection final : public hal::ReportSource {
 public:
  /// `descriptor`: nothing if the device's could not be decoded.
  LiveInspection(hal::ReportSource& source, std::optional<hal::ReportDescriptor> descriptor)
      : source_(source), descriptor_(std::move(descriptor)) {}

  hal::Status open() override { return source_.open(); }
  hal::Status read(TimeNs deadline_ns, hal::RawReport& report) override;
  void close() override { source_.close(); }
  hal::TransportCounts counts() const override { return source_.counts(); }

  /// What the reports show so far, in words: for each number the rate and its jitter, the last
  /// bytes, the values the descriptor gives them, what changes and what looks like a counter.
  std::string words() const;
  /// The same for programs.
  nlohmann::ordered_json json() const;

 private:
  hal::ReportSource& source_;
  std::optional<hal::ReportDescriptor> descriptor_;
  std::map<std::uint8_t, ReportWatch> watches_;  // by report id; 0: not numbered
};

/// What a profile makes of the last report, in words: millimetres, the counter, what was lost, the
/// clock.
std::string profile_words(const hal::DeviceProfile& profile, const hal::DeviceFacebow& facebow);

}  // namespace condyle::host
