// SPDX-License-Identifier: Apache-2.0
// The devices of a session that is being recorded: the facebow, and instruments beside it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "condyle/hal/log/recorded_source.h"
#include "hosted/devices/companion.h"
#include "hosted/devices/connected_device.h"
#include "hosted/devices/stream_spec.h"
#include "hosted/lsl/inlet.h"

namespace condyle::host {

/// A device of the session, and what its reports mean.
struct SessionDevice {
  std::string name;  ///< used in messages: the profile's file
  std::string profile_text;
  hal::DeviceProfile profile;
  hal::DeviceAddress address;
  // One of the two.
  std::unique_ptr<ConnectedDevice> device;
  std::unique_ptr<lsl::Inlet> inlet;     ///< a stream
  std::vector<std::uint8_t> descriptor;  ///< set once it was described

  hal::ReportSource& source() const;
};

/// The device that the profile in a file describes, not opened; `serial`: see DeviceAddress.
SessionDevice make_session_device(const std::string& profile_path, const std::string& serial,
                                  const std::string& backend, hal::Clock& clock);

/// The stream of the Lab Streaming Layer that `stream` names, which must be there.
/// Throws an InputError if it is not, or if it is not clear which of its channels are the position,
/// and in which unit.
SessionDevice make_session_stream(const StreamSpec& stream, hal::Clock& clock,
                                  const std::function<bool()>& stop);

/// Throws an InputError if both may be the same device by ids, interfaces and serial numbers.
void reject_duplicate_devices(const SessionDevice& first, const SessionDevice& second);
/// The same for any two of `devices`.
void reject_duplicate_devices(const std::vector<SessionDevice>& devices);

/// Reads the device's descriptor, completes the profile from it, and closes the device. From here
/// on its serial number, if it has one, belongs to the address, so that a device plugged in later
/// is not mistaken for it. See ConnectedDevice::open; also throws an InputError if several devices
/// match.
void probe_device(SessionDevice& device, const std::function<bool()>& stop);

/// A companion whose reports go into a log.
struct RecordedCompanion {
  /// `source_index`: of `device` in the log's header.
  RecordedCompanion(const SessionDevice& device, hal::SessionLogWriter& log,
                    std::size_t source_index, hal::Clock& clock)
      : profile(device.profile),
        source(device.source(), log, source_index, clock),
        companion(source, profile, clock) {}

  hal::DeviceProfile profile;
  hal::RecordedSource source;
  Companion companion;
};

}  // namespace condyle::host
