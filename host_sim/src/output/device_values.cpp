// SPDX-License-Identifier: Apache-2.0
#include "output/device_values.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/device_facebow.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/devices/device_text.h"
#include "hosted/devices/log_device.h"
#include "hosted/devices/source_spec.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "recordings/device_recording.h"
#include "recordings/session_markers.h"

namespace condyle::host {
namespace {

std::string header_of(const hal::DeviceProfile& profile) {
  std::string header = "time_s";
  if (profile.drive_N) header += ",drive_N";
  for (const hal::AuxiliaryField& field : profile.auxiliary) {
    header += "," + field.name + (field.unit == "1" ? "" : "_" + field.unit);
  }
  return header + "\n";
}

void append_value(std::string& row, bool is_valid, double value) {
  row += ',';
  if (is_valid) append_number(row, value);
}

// Counts of reports, as text.
std::string write_rows(hal::ReportSource& source, const hal::DeviceProfile& profile,
                       OutputFile& file) {
  hal::DeviceFacebow device(source, hal::layout_of(profile));
  Sample sample;
  std::string row;
  for (;;) {
    const hal::Status status = device.read(hal::kNoDeadline, sample);
    if (status == hal::Status::bad_report) continue;
    if (status == hal::Status::disconnected && device.open() == hal::Status::ok) continue;
    if (status != hal::Status::ok) {
      std::string words = reports_text(profile, device.counts(), device.transport_counts());
      if (profile.device_time) words += "; " + clock_text(device.clock_fit());
      return words;
    }
    row.clear();
    append_time_s(row, sample.time_ns);
    if (profile.drive_N) append_value(row, sample.drive_valid, sample.drive_N);
    for (std::size_t i = 0; i < profile.auxiliary.size(); ++i) {
      const hal::MeasuredValue& value = device.last_report().auxiliary[i];
      append_value(row, value.valid, value.value);
    }
    file.write(row += '\n');
  }
}

bool has_values(const hal::DeviceProfile& profile) {
  return profile.drive_N.has_value() || !profile.auxiliary.empty();
}

// The file of the device called `name`; adds notes on its reports for the user.
void write_file(hal::ReportSource& source, const hal::DeviceProfile& profile,
                const std::string& folder, const std::string& name,
                std::vector<std::unique_ptr<OutputFile>>& files, std::vector<std::string>& notes) {
  files.push_back(
      std::make_unique<OutputFile>((std::filesystem::path(folder) / (name + ".csv")).string()));
  files.back()->write(header_of(profile));
  notes.push_back(name + ": " + write_rows(source, profile, *files.back()));
  files.back()->close();
}

void write_captured_values(const std::string& capture, const std::string& profile_path,
                           const std::string& folder,
                           std::vector<std::unique_ptr<OutputFile>>& files,
                           std::vector<std::string>& notes) {
  hal::DeviceProfile profile = load_device_profile(profile_path);
  if (!has_values(profile)) return;
  complete_profile(profile, {}, capture);
  write_file(*open_captured_reports(capture, profile), profile, folder, "facebow", files, notes);
}

void write_logged_values(const std::string& log, const std::string& profile_path,
                         const std::string& folder, std::vector<std::unique_ptr<OutputFile>>& files,
                         std::vector<std::string>& notes) {
  for (auto device = open_log_device(log, 0, profile_path, has_values); device;
       device = open_log_device(log, device->index + 1, profile_path, has_values)) {
    write_file(*device->reports, device->profile, folder, device->recorded().name, files, notes);
    if (device->reports->not_recorded() > 0) {
      notes.back() += fmt::format("; the recorder dropped {} reports and events",
                                  device->reports->not_recorded());
    }
  }
  const std::vector<SessionMarker> markers = read_markers(log);
  if (markers.empty()) return;
  const std::filesystem::path path = std::filesystem::path(folder) / "markers.csv";
  files.push_back(std::make_unique<OutputFile>(path.string()));
  files.back()->write(markers_csv(markers));
  files.back()->close();
  notes.push_back(fmt::format("markers: {}", markers.size()));
}

}  // namespace

std::vector<std::string> write_device_values(const std::string& recording,
                                             const std::string& profile_path,
                                             const std::string& folder,
                                             std::vector<std::unique_ptr<OutputFile>>& files) {
  const std::string path = source_of(recording).file;
  std::vector<std::string> notes;
  switch (report_file_at(path)) {
    case ReportFile::capture:
      write_captured_values(path, profile_path, folder, files, notes);
      break;
    case ReportFile::session_log:
      write_logged_values(path, profile_path, folder, files, notes);
      break;
    case ReportFile::none:
      throw InputError(
          path, "contains no values other than positions",
          "leave out --values; it writes the drive and auxiliary fields of a device's profile");
  }
  if (files.empty()) {
    notes.emplace_back("it contains no values other than positions: --values wrote no file");
  }
  return notes;
}

}  // namespace condyle::host
