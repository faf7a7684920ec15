// SPDX-License-Identifier: Apache-2.0
#include "hosted/devices/configured_facebow.h"

#include "hosted/config/device_profile_file.h"
#include "hosted/devices/device_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/text_file.h"

namespace condyle::host {

ConfiguredFacebow::ConfiguredFacebow(const SourceSpec& spec, const std::string& serial,
                                     hal::Clock& clock)
    : name_(spec.file) {
  switch (spec.kind) {
    case SourceKind::file:
      log_ = std::make_unique<LogReplaySource>(spec.file, clock);
      profile_text_ = log_->device().recorded().profile_toml;
      descriptor_ = log_->device().recorded().report_descriptor;
      profile_ = log_->device().profile;
      break;
    case SourceKind::synth:
      profile_text_ = read_text_file(spec.file);
      profile_ = parse_device_profile(spec.file, profile_text_);
      if (profile_.kind != SampleKind::three_points || profile_.vendor_id != 0x1209 ||
          profile_.product_id != 0x0001) {
        throw InputError(spec.file, "does not describe what a synthetic facebow sends",
                         "name condyle_facebow.toml, which comes with condyle");
      }
      synthetic_ =
          std::make_unique<SyntheticSource>(profile_.rate_Hz > 0 ? profile_.rate_Hz : 200, clock);
      break;
    case SourceKind::hid:
    case SourceKind::usb:
      device_ = std::make_unique<SessionDevice>(
          make_session_device(spec.file, serial, backend_of(spec.kind), clock));
      profile_text_ = device_->profile_text;
      profile_ = device_->profile;
      break;
    case SourceKind::sim:
      throw InputError("sim:" + spec.file, "a simulated subject does not send reports",
                       "name a device or a session log");
  }
  require_position(profile_, name_);
}

ConfiguredFacebow::ConfiguredFacebow(const StreamSpec& stream, hal::Clock& clock)
    : name_("lsl:" + stream.place),
      device_(std::make_unique<SessionDevice>(
          make_session_stream(stream, clock, [] { return false; }))) {
  profile_text_ = device_->profile_text;
  profile_ = device_->profile;
}

void ConfiguredFacebow::find(const std::function<bool()>& stop) {
  if (device_) {
    probe_device(*device_, stop);
    profile_ = device_->profile;
    descriptor_ = device_->descriptor;
  } else {
    complete_profile(profile_, descriptor_, name_);
  }
}

hal::ReportSource& ConfiguredFacebow::source() {
  if (device_) return device_->source();
  if (log_) return *log_;
  return *synthetic_;
}

}  // namespace condyle::host
