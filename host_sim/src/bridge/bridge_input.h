// SPDX-License-Identifier: Apache-2.0
// What a bridge feeds a target with: the reports of a device or of a session log, or the samples of
// a recording, each made a report of its own.
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

/// Reports, what they mean, and how they are to be followed.
struct BridgeInput {
  std::string words;  ///< "session log of condyle facebow"
  bool is_live = false;
  bool has_drive = false;
  hal::ReportLayout layout;
  std::optional<TimeNs> nominal_step_ns;      ///< for gaps
  std::optional<TimeNs> median_step_ns;       ///< as recorded; of a device as its profile says
  std::shared_ptr<hal::ReportSource> source;  ///< open
  std::function<double()> progress;           ///< share read so far; 0 if it is not known
  std::function<std::string()> problem;       ///< of the recording; empty if there is none
};

/// Opens `name`: "hid:PROFILE", "usb:PROFILE" or "synth:PROFILE", a device; else a recording (see
/// open_recording).
/// `serial`: of a device, if several are plugged in; it is waited for until `stop`. An
/// InputError where it cannot be used.
BridgeInput open_bridge_input(const std::string& name, const std::string& serial,
                              const RecordingOptions& options, hal::Clock& clock,
                              const std::function<bool()>& stop);

}  // namespace condyle::host
