// SPDX-License-Identifier: Apache-2.0
#include "box/sources/facebow_reports.h"

#include "hosted/config/device_profile_file.h"
#include "hosted/devices/device_words.h"
#include "hosted/files/input_error.h"
#include "hosted/files/text_file.h"

namespace condyle::box {

using host::InputError;
using Kind = SourceSettings::Kind;

FacebowReports::FacebowReports(const SourceSettings& settings, hal::Clock& clock)
    : name_(settings.file) {
  if (settings.kind == Kind::file) {
    log_ = std::make_unique<PlayedLog>(settings.file, clock);
    const hal::Status status = log_->open();
    if (status != hal::Status::ok) {
      throw InputError(settings.file,
                       log_->problem().empty() ? hal::status_name(status) : log_->problem(),
                       "name a session log");
    }
    const hal::SessionSource& recorded = log_->header().sources.front();
    name_ += ": its profile";
    profile_text_ = recorded.profile_toml;
    descriptor_ = recorded.report_descriptor;
    profile_ = host::parse_device_profile(name_, profile_text_);
  } else if (settings.kind == Kind::synth) {
    profile_text_ = host::read_text_file(settings.file);
    profile_ = host::parse_device_profile(settings.file, profile_text_);
    if (profile_.kind != SampleKind::three_points || profile_.vendor_id != 0x1209 ||
        profile_.product_id != 0x0001) {
      throw InputError(settings.file, "does not describe what a synthetic facebow sends",
                       "name condyle_facebow.toml, which comes with condyle");
    }
    synthetic_ =
        std::make_unique<SyntheticSource>(profile_.rate_Hz > 0 ? profile_.rate_Hz : 200, clock);
  } else {
    device_ = std::make_unique<host::SessionDevice>(host::name_device(
        settings.file, settings.serial, settings.kind == Kind::usb ? "libusb" : "hidapi", clock));
    profile_text_ = device_->profile_text;
    profile_ = device_->profile;
  }
  host::require_position(profile_, name_);
}

void FacebowReports::find(const std::function<bool()>& stop) {
  if (device_) {
    host::describe(*device_, stop);
    profile_ = device_->profile;
    descriptor_ = device_->descriptor;
  } else {
    host::complete_profile(profile_, descriptor_, name_);
  }
}

hal::ReportSource& FacebowReports::source() {
  if (device_) return device_->device->source();
  if (log_) return *log_;
  return *synthetic_;
}

}  // namespace condyle::box
