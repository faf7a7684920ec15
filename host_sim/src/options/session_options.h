// SPDX-License-Identifier: Apache-2.0
// The option --session of compare and report.
#pragma once

#include <string>
#include <vector>

#include "comparison/session_comparison.h"

namespace condyle::host {

/// A session as given on the command line.
struct SessionFiles {
  std::string name;
  std::vector<std::string> recordings;
};

/// The sessions of the values of --session, at least two, with different names. Throws InputError.
std::vector<SessionFiles> parse_sessions(const std::vector<std::string>& texts);

/// All recordings of `sessions`, in order.
std::vector<std::string> recordings_of(const std::vector<SessionFiles>& sessions);

/// The `reports` of recordings_of(files), by session.
std::vector<Session> sessions_of(const std::vector<SessionFiles>& files,
                                 std::vector<RecordingReport> reports);

/// Throws InputError if `option` gives one of `names` twice.
void refuse_repeated_names(const char* option, const std::vector<std::string>& names);

}  // namespace condyle::host
