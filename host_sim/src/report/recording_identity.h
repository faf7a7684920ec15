// SPDX-License-Identifier: Apache-2.0
// Which files a report rests on, and what a session log states about its session.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace condyle::host {

/// A file and its bytes.
struct FileIdentity {
  std::string role;  ///< "recording", "landmarks", ...
  std::string name;  ///< as the user gave it
  std::string sha1;  ///< 40 hexadecimal digits; empty: it could not be read again
};

/// What a session log states.
struct SessionIdentity {
  std::string subject_code;  ///< empty: none given
  std::string begin_utc;     ///< "2026-01-31 12:00:00"
  std::string recorder;      ///< version of the software that recorded
  std::vector<std::string> devices;
};

/// Of one recording.
struct RecordingIdentity {
  std::vector<FileIdentity> files;
  std::optional<SessionIdentity> session;  ///< of a session log
};

/// Of the recording `source`, with the other files that its analysis reads: `others`, those without
/// a name left out.
RecordingIdentity identity_of(const std::string& source, const std::vector<FileIdentity>& others);

/// The same as data.
nlohmann::ordered_json identity_json(const RecordingIdentity& identity);

}  // namespace condyle::host
