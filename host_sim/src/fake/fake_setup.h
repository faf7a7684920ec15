// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fake/facebow_device.h"
#include "fake/fake_run.h"
#include "fake/fault_script.h"
#include "recordings/recording.h"

namespace condyle::host::fake {

/// The user's options for the fake facebow.
struct FakeOptions {
  RecordingOptions reading;       ///< of the motion
  std::string motion;             ///< a recording, as open_recording takes it; empty: a simulation
  bool stops_at_end = false;      ///< of the motion; otherwise it repeats
  std::optional<double> rate_Hz;  ///< absent: the motion's
  std::string fault_file;
  std::vector<std::string> faults;    ///< further ones, as text
  std::optional<std::uint64_t> seed;  ///< of faults and garbage, instead of the file's
  DeviceOptions device;
  RunOptions run;  ///< rate and seed are overwritten
};

/// A device ready to run.
struct FakeSetup {
  FacebowDevice device;
  FaultScript script;
  RunOptions run;
  std::string description;  ///< for the user
};

/// Builds the device; InputErrors of motion and faults.
FakeSetup set_up(const FakeOptions& options);

}  // namespace condyle::host::fake
