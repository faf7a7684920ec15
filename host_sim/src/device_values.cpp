// SPDX-License-Identifier: Apache-2.0
#include "device_values.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "condyle/hal/device_facebow.h"
#include "condyle/hal/session_log_source.h"
#include "device_profile_file.h"
#include "device_words.h"
#include "input_error.h"
#include "number_text.h"

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

// Gives what became of the reports, in words.
std::string write_rows(hal::SessionLogSource& source, const hal::DeviceProfile& profile,
                       OutputFile& file) {
  hal::DeviceFacebow device(source, profile);
  Sample sample;
  std::string row;
  for (;;) {
    const hal::Status status = device.read(hal::kNoDeadline, sample);
    if (status == hal::Status::bad_report) continue;
    if (status == hal::Status::disconnected && device.open() == hal::Status::ok) continue;
    if (status != hal::Status::ok) {
      std::string words = reports_words(profile, device.counts(), device.transport_counts());
      if (profile.device_time) words += "; " + clock_words(device.clock_fit());
      if (source.not_recorded() > 0) {
        words += fmt::format("; the recorder had no room for {} reports and events",
                             source.not_recorded());
      }
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

}  // namespace

std::vector<std::string> write_device_values(const std::string& log,
                                             const std::string& profile_path,
                                             const std::string& folder,
                                             std::vector<std::unique_ptr<OutputFile>>& files) {
  std::vector<std::string> notes;
  std::size_t sources = 1;
  for (std::size_t i = 0; i < sources; ++i) {
    hal::SessionLogSource source(log, i);
    if (source.open() != hal::Status::ok) throw InputError(log, source.problem(), "");
    sources = source.header().sources.size();
    const hal::SessionSource& device = source.header().sources[i];
    hal::DeviceProfile profile =
        i == 0 && !profile_path.empty()
            ? load_device_profile(profile_path)
            : parse_device_profile(log + ": the profile of " + device.name, device.profile_toml);
    if (!profile.drive_N && profile.auxiliary.empty()) continue;
    complete_profile(profile, device.report_descriptor, log);
    files.push_back(std::make_unique<OutputFile>(
        (std::filesystem::path(folder) / (device.name + ".csv")).string()));
    files.back()->write(header_of(profile));
    notes.push_back(device.name + ": " + write_rows(source, profile, *files.back()));
    files.back()->close();
  }
  if (files.empty()) {
    throw InputError(
        log, "holds no value but position",
        "leave --values out; a drive or auxiliary fields are in the profile of a device");
  }
  return notes;
}

}  // namespace condyle::host
