// SPDX-License-Identifier: Apache-2.0
// What a bridge sends to a microcontroller: the reports of a device or of a session log, or the
// samples of a recording, each as a report.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "condyle/hal/clock.h"
#include "condyle/hal/report/raw_report.h"
#include "condyle/hal/report/report_layout.h"
#include "recordings/recording.h"

namespace condyle::host {

/// Reports, their meaning, and what is followed in them.
struct BridgeInput {
  std::string words;  ///< "session log of condyle facebow"
  bool is_live = false;
  bool has_drive = false;
  hal::ReportLayout layout;
  std::optional<TimeNs> nominal_step_ns;      ///< for gaps
  std::optional<TimeNs> median_step_ns;       ///< as recorded; for a device, from its profile
  std::shared_ptr<hal::ReportSource> source;  ///< open
  std::function<double()> progress;           ///< share read so far; 0 if it is not known
  std::function<std::string()> problem;       ///< of the recording; empty if there is none
};

/// Opens `name`: "hid:PROFILE", "usb:PROFILE" or "synth:PROFILE", a device; otherwise a recording
/// (see open_recording). `serial`: of a device, if several are plugged in; the call waits for it
/// until `stop`. Throws InputError if it cannot be used.
BridgeInput open_bridge_input(const std::string& name, const std::string& serial,
                              const RecordingOptions& options, hal::Clock& clock,
                              const std::function<bool()>& stop);

}  // namespace condyle::host
