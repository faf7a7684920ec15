// SPDX-License-Identifier: Apache-2.0
#include "report/recording_identity.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "condyle/hal/log/session_log_reader.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "recordings/file_digest.h"
#include "recordings/recording_files.h"

namespace condyle::host {
namespace {

std::string device_text(const hal::SessionSource& source) {
  std::string text = source.name;
  try {
    text += " " + parse_device_profile(source.name, source.profile_toml).name;
  } catch (const InputError&) {
    text += " (its profile cannot be read)";
  }
  return fmt::format("{}, USB {:04x}:{:04x}", text, source.vendor_id, source.product_id);
}

std::string utc_text(TimeNs wall_ns) {
  const auto seconds = static_cast<std::time_t>(wall_ns / kNanosecondsPerSecond);
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::gmtime(seconds));
}

std::optional<SessionIdentity> session_of(const std::string& log) {
  hal::SessionLogReader reader;
  if (reader.open(log) != hal::Status::ok) return std::nullopt;
  const hal::SessionHeader& header = reader.header();
  SessionIdentity session{
      header.subject_code, utc_text(header.start_wall_ns), header.software_version, {}};
  for (const hal::SessionSource& source : header.sources) {
    if (hal::is_device(source)) session.devices.push_back(device_text(source));
  }
  return session;
}

FileIdentity with_digest(FileIdentity file) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(file.name, failure)) return file;  // a pipe is read once
  try {
    file.sha1 = file_digest(file.name);
  } catch (const InputError&) {
    file.sha1.clear();
  }
  return file;
}

}  // namespace

RecordingIdentity identity_of(const std::string& source, const std::vector<FileIdentity>& others) {
  RecordingIdentity identity;
  const std::vector<std::string> files = recording_files(source);
  for (const std::string& file : files) {
    identity.files.push_back(with_digest({"recording", file, ""}));
  }
  for (const FileIdentity& other : others) {
    if (!other.name.empty()) identity.files.push_back(with_digest(other));
  }
  if (files.size() == 1) identity.session = session_of(files[0]);
  return identity;
}

nlohmann::ordered_json identity_json(const RecordingIdentity& identity) {
  using Json = nlohmann::ordered_json;
  Json json = {{"files", Json::array()}, {"session", nullptr}};
  for (const FileIdentity& file : identity.files) {
    json["files"].push_back({{"role", file.role},
                             {"name", clean_line(file.name)},
                             {"sha1", file.sha1.empty() ? Json() : Json(file.sha1)}});
  }
  if (!identity.session) return json;
  const SessionIdentity& session = *identity.session;
  json["session"] = {{"subject_code", clean_line(session.subject_code)},
                     {"begin_utc", session.begin_utc},
                     {"recorder", clean_line(session.recorder)},
                     {"devices", Json::array()}};
  for (const std::string& device : session.devices) {
    json["session"]["devices"].push_back(clean_line(device));
  }
  return json;
}

}  // namespace condyle::host
