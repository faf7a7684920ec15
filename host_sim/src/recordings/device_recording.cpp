// SPDX-License-Identifier: Apache-2.0
#include "recordings/device_recording.h"

#include <fmt/format.h>

#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/log/usbmon_capture.h"
#include "condyle/hal/report/device_facebow.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/devices/device_text.h"
#include "hosted/devices/log_device.h"
#include "hosted/files/input_error.h"
#include "recordings/session_markers.h"

namespace condyle::host {
namespace {

// `Source`: SessionLogSource or UsbmonCapture, which both report problems of their file.
template <class Source>
class DeviceRecording : public Recording {
 public:
  DeviceRecording(const std::string& path, std::unique_ptr<Source> source,
                  const hal::DeviceProfile& profile, std::string format)
      : path_(path),
        source_(std::move(source)),
        profile_(profile),
        facebow_(*source_, hal::layout_of(profile_)) {
    info_.format = std::move(format);
    info_.kind = profile.kind;
    info_.has_drive = profile.drive_N.has_value();
    info_.is_of_device = true;
    if constexpr (std::is_same_v<Source, hal::SessionLogSource>) {
      info_.parameters_toml = source_->header().parameters_toml;
      info_.begun_with_json = source_->header().begun_with_json;
    }
    info_.nominal_step_ns = profile.nominal_step_ns();
  }

  bool next(Sample& sample) override {
    hal::Status status = read(sample);
    while (status != hal::Status::ok && status != hal::Status::end) status = read(sample);
    return status == hal::Status::ok;
  }
  hal::Status read(Sample& sample) override {
    const hal::Status status = facebow_.read(hal::kNoDeadline, sample);
    if (status == hal::Status::ok) ++samples_;
    const bool goes_on =
        status == hal::Status::ok || status == hal::Status::bad_report ||
        (status == hal::Status::disconnected && facebow_.open() == hal::Status::ok);
    if (goes_on) return status;
    describe_end();
    return hal::Status::end;
  }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return fmt::format("{}: sample {}", path_, samples_); }
  double progress() const override { return source_->progress(); }

 private:
  void describe_end() {
    if (has_ended_) return;
    has_ended_ = true;
    info_.notes.push_back(reports_text(profile_, facebow_.counts(), facebow_.transport_counts()));
    if (profile_.device_time) info_.notes.push_back(clock_text(facebow_.clock_fit()));
    if constexpr (std::is_same_v<Source, hal::SessionLogSource>) {
      if (source_->condition().outcome != hal::McapRead::end) {
        info_.notes.push_back(path_ + ": " + hal::describe(source_->condition()));
      }
      for (std::string& note : marker_notes(read_markers(path_))) {
        info_.notes.push_back(std::move(note));
      }
      if (source_->not_recorded() > 0) {
        info_.notes.push_back(
            fmt::format("the recorder dropped {} reports and events", source_->not_recorded()));
      }
    } else {
      if (!source_->problem().empty()) info_.notes.push_back(source_->problem());
      if (source_->usbmon_counts().cut_reports > 0) {
        info_.notes.push_back(fmt::format("{} reports were shortened by the capture and left out",
                                          source_->usbmon_counts().cut_reports));
      }
    }
  }

  std::string path_;
  std::unique_ptr<Source> source_;
  hal::DeviceProfile profile_;
  hal::DeviceFacebow facebow_;
  RecordingInfo info_;
  std::uint64_t samples_ = 0;
  bool has_ended_ = false;
};

std::unique_ptr<Recording> recording_of(const std::string& path, LogDevice device) {
  std::string format = fmt::format("session log of {}", device.profile.name);
  return std::make_unique<DeviceRecording<hal::SessionLogSource>>(
      path, std::move(device.reports), device.profile, std::move(format));
}

}  // namespace

std::unique_ptr<Recording> open_session_log(const std::string& path,
                                            const RecordingOptions& options) {
  return recording_of(path, open_log_facebow(path, options.profile));
}

std::unique_ptr<Recording> open_logged_drive(const std::string& path) {
  auto device = open_log_device(
      path, 0, "", [](const hal::DeviceProfile& profile) { return profile.drive_N.has_value(); });
  if (device) return recording_of(path, std::move(*device));
  throw InputError(path, "no device in it measured a drive",
                   "give a session log with a [drive] in one of its profiles");
}

std::unique_ptr<hal::UsbmonCapture> open_captured_reports(const std::string& path,
                                                          const hal::DeviceProfile& profile) {
  auto source =
      std::make_unique<hal::UsbmonCapture>(path, hal::UsbmonChoice{.vendor_id = profile.vendor_id,
                                                                   .product_id = profile.product_id,
                                                                   .bus = {},
                                                                   .device = {},
                                                                   .endpoint = {}});
  const hal::Status status = source->open();
  if (status == hal::Status::ok) return source;
  throw InputError(path, source->problem().empty() ? hal::status_name(status) : source->problem(),
                   "give a file with the reports of a facebow");
}

std::unique_ptr<Recording> open_capture(const std::string& path, const RecordingOptions& options) {
  if (options.profile.empty()) {
    throw InputError(path, "is a capture of USB traffic, which does not describe its reports",
                     "give the device's profile with --profile");
  }
  hal::DeviceProfile profile = load_device_profile(options.profile);
  require_position(profile, options.profile);
  complete_profile(profile, {}, path);
  auto source = open_captured_reports(path, profile);
  std::string format = fmt::format("capture of {}", profile.name);
  return std::make_unique<DeviceRecording<hal::UsbmonCapture>>(path, std::move(source), profile,
                                                               std::move(format));
}

}  // namespace condyle::host
