// SPDX-License-Identifier: Apache-2.0
// Recordings of a device's raw reports: session logs (MCAP) and captures of USB traffic (pcap and
// pcapng). They are decoded like a live device.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "condyle/hal/hid/device_profile.h"
#include "condyle/hal/log/usbmon_capture.h"
#include "recordings/recording.h"

namespace condyle::host {

/// Reads the log's first device, with the profile in the log or with `options.profile`.
std::unique_ptr<Recording> open_session_log(const std::string& path,
                                            const RecordingOptions& options);
/// Reads the log's first device whose profile has a drive.
std::unique_ptr<Recording> open_logged_drive(const std::string& path);
/// The reports of the device of `profile` in the capture, opened.
std::unique_ptr<hal::UsbmonCapture> open_captured_reports(const std::string& path,
                                                          const hal::DeviceProfile& profile);
/// Reads the capture of the device that `options.profile`, which must be given, describes.
std::unique_ptr<Recording> open_capture(const std::string& path, const RecordingOptions& options);

}  // namespace condyle::host
