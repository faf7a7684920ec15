// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "box/outlets/document.h"
#include "box/recording/session_file_name.h"

namespace condyle::box {

/// The session logs in the folder of the recordings, as documents: JSON of the format
/// condyle-box-sessions-1, logs, and their reports. They may wait for the disk. They hold what they
/// use, because the box may end before them.
class SessionFiles {
 public:
  /// `make_report`: as in Configuration.
  SessionFiles(std::string folder, std::function<std::string(const std::string&)> make_report)
      : folder_(std::move(folder)), make_report_(std::move(make_report)) {}

  /// `recorded`: name of the log that is being written, or empty; it cannot be had yet.
  Document::Make list(const std::string& recorded) const;
  Document::Make log(const std::string& name, const std::string& recorded) const;
  Document::Make report(const std::string& name, const std::string& recorded) const;

 private:
  std::string folder_;
  std::function<std::string(const std::string&)> make_report_;
};

}  // namespace condyle::box
