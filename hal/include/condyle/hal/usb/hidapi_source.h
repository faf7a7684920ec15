// SPDX-License-Identifier: Apache-2.0
// Reads reports through the kernel's HID driver (hidapi on /dev/hidraw*): other programs can still
// use the device. The kernel keeps 64 reports for a slow reader, then drops the newest; on unplug
// it drops what it keeps. Only the device's counter shows how many were lost.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "condyle/hal/clock.h"
#include "condyle/hal/report/raw_report.h"
#include "condyle/hal/usb/device_address.h"

struct hid_device_;  // hidapi's

namespace condyle::hal {

/// See ReportSource. Uses the first device that `address` matches. Setting up allocates; reading
/// does not.
class HidapiSource final : public ReportSource {
 public:
  HidapiSource(DeviceAddress address, Clock& clock);
  ~HidapiSource();
  HidapiSource(const HidapiSource&) = delete;
  HidapiSource& operator=(const HidapiSource&) = delete;

  /// ok, not_found or not_permitted.
  Status open() override;
  /// A signal ends the wait early, with timeout.
  Status read(TimeNs deadline_ns, RawReport& report) override;
  void close() override;
  TransportCounts counts() const override { return counts_; }

  /// The report descriptor of the device opened last; empty if it is gone.
  std::vector<std::uint8_t> report_descriptor() const;
  /// "/dev/hidraw3", of the device opened last.
  const std::string& path() const { return path_; }

 private:
  DeviceAddress address_;
  Clock& clock_;
  hid_device_* device_ = nullptr;
  std::string path_;
  TransportCounts counts_;
  std::array<std::uint8_t, kMaxReportSize + 1> buffer_{};
};

}  // namespace condyle::hal
