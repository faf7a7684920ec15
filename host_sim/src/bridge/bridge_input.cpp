// SPDX-License-Identifier: Apache-2.0
#include "bridge/bridge_input.h"

#include <fmt/format.h>

#include <bit>
#include <limits>

#include "condyle/hal/hid/profile_check.h"
#include "hosted/devices/configured_facebow.h"
#include "hosted/devices/log_device.h"
#include "hosted/files/input_error.h"
#include "recordings/replay_facebow.h"

namespace condyle::host {
namespace {

constexpr std::uint32_t kNumberBits = 64;

void put_number(double value, std::size_t place, hal::RawReport& report) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (std::size_t byte = 0; byte < sizeof bits; ++byte) {
    report.bytes[sizeof bits * place + byte] = static_cast<std::uint8_t>(bits >> (8 * byte));
  }
}

// The samples of a recording as reports: the numbers in order, NaN for a missing one, at the time
// of the sample.
class SampleReports final : public hal::ReportSource {
 public:
  SampleReports(const std::string& path, const RecordingOptions& options, hal::Clock& clock)
      : facebow_(path, options, 0, clock) {}

  hal::Status open() override { return facebow_.open(); }
  hal::Status read(TimeNs deadline_ns, hal::RawReport& report) override {
    Sample sample;
    const hal::Status status = facebow_.read_past_bad_reports(deadline_ns, sample);
    if (status != hal::Status::ok) return status;
    if (!sample.time_valid) return hal::Status::bad_report;
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const std::size_t count = coordinate_count(sample.kind);
    report.host_time_ns = sample.time_ns;
    // Values out of range pass unchanged: the decoder reports them.
    const bool has_numbers =
        sample.position_valid || is_out_of_range(sample.kind, sample.coordinates);
    for (std::size_t i = 0; i < count; ++i) {
      put_number(has_numbers ? sample.coordinates[i] : kNone, i, report);
    }
    put_number(sample.drive_valid ? sample.drive_N : kNone, count, report);
    report.size = static_cast<std::uint16_t>(sizeof(double) * (count + 1));
    return hal::Status::ok;
  }
  void close() override { facebow_.close(); }
  hal::TransportCounts counts() const override { return {}; }

  const ReplayFacebow& facebow() const { return facebow_; }
  hal::ReportLayout layout() const {
    hal::ReportLayout layout;
    layout.kind = facebow_.info().kind;
    const auto number = [](std::size_t place) {
      hal::ReportField field;
      field.offset_bits = kNumberBits * static_cast<std::uint32_t>(place);
      field.width_bits = kNumberBits;
      field.type = hal::FieldType::floating_point;
      return field;
    };
    const std::size_t count = coordinate_count(layout.kind);
    for (std::size_t i = 0; i < count; ++i) (void)layout.coordinates.push_back({number(i), i});
    if (facebow_.info().has_drive) layout.drive_N = number(count);
    layout.minimum_size_bytes = sizeof(double) * (count + 1);
    return layout;
  }

 private:
  ReplayFacebow facebow_;
};

BridgeInput of_samples(const std::string& path, const RecordingOptions& options,
                       hal::Clock& clock) {
  const auto reports = std::make_shared<SampleReports>(path, options, clock);
  const ReplayFacebow& facebow = reports->facebow();
  if (reports->open() != hal::Status::ok) throw InputError(facebow.problem());
  BridgeInput input;
  input.words = facebow.info().format;
  input.has_drive = facebow.info().has_drive;
  input.layout = reports->layout();
  input.median_step_ns = facebow.median_step_ns();
  input.nominal_step_ns =
      facebow.info().is_of_device ? facebow.info().nominal_step_ns : facebow.median_step_ns();
  input.progress = [reports] { return reports->facebow().progress(); };
  input.problem = [reports] { return reports->facebow().problem(); };
  input.source = reports;
  return input;
}

// The part of a device's profile that describes its reports.
void describe_by(const hal::DeviceProfile& profile, BridgeInput& input) {
  input.layout = hal::layout_of(profile);
  input.has_drive = profile.drive_N.has_value();
  input.nominal_step_ns = profile.nominal_step_ns();
  input.median_step_ns = input.nominal_step_ns;
  input.progress = [] { return 0.0; };
}

BridgeInput of_session_log(const std::string& path, const RecordingOptions& options) {
  const auto device = std::make_shared<LogDevice>(open_log_facebow(path, options.profile));
  BridgeInput input;
  input.words = "session log of " + device->profile.name;
  describe_by(device->profile, input);
  input.progress = [device] { return device->reports->progress(); };
  input.problem = [device] { return device->reports->problem(); };
  input.source = {device, device->reports.get()};
  return input;
}

BridgeInput of_device(const SourceSpec& spec, const std::string& serial, hal::Clock& clock,
                      const std::function<bool()>& stop) {
  const auto facebow = std::make_shared<ConfiguredFacebow>(spec, serial, clock);
  facebow->find(stop);
  BridgeInput input;
  input.words = facebow->profile().name +
                (facebow->device() == nullptr ? ", synthetic"
                                              : fmt::format(", through {}", backend_of(spec.kind)));
  input.is_live = true;
  describe_by(facebow->profile(), input);
  input.problem = [] { return std::string(); };
  input.source = {facebow, &facebow->source()};
  if (input.source->open() != hal::Status::ok) {
    throw InputError(spec.file, "the device cannot be opened", "run condyle doctor to see why");
  }
  return input;
}

}  // namespace

BridgeInput open_bridge_input(const std::string& name, const std::string& serial,
                              const RecordingOptions& options, hal::Clock& clock,
                              const std::function<bool()>& stop) {
  const SourceSpec spec = recording_source(name);
  switch (spec.kind) {
    case SourceKind::hid:
    case SourceKind::usb:
    case SourceKind::synth:
      return of_device(spec, serial, clock, stop);
    case SourceKind::file:
      if (report_file_at(spec.file) == ReportFile::session_log) {
        return of_session_log(spec.file, options);
      }
      break;
    case SourceKind::sim:
      break;
  }
  return of_samples(name, options, clock);
}

}  // namespace condyle::host
