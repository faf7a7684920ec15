// SPDX-License-Identifier: Apache-2.0
#include "options/session_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

SessionFiles parse_session(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError("--session " + text, "lacks a name or recordings",
                     "write --session before=A.csv,B.csv,C.csv");
  }
  SessionFiles session{text.substr(0, equals), {}};
  for (std::size_t begin = equals + 1; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    if (end == begin) {
      throw InputError("--session " + session.name,
                       end == text.size() && begin == equals + 1 ? "has no recordings"
                                                                 : "one of its names is empty",
                       "write --session before=A.csv,B.csv,C.csv");
    }
    session.recordings.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  if (text.ends_with(',')) {
    throw InputError("--session " + session.name, "one of its names is empty",
                     "remove the last comma");
  }
  return session;
}

}  // namespace

void refuse_repeated_names(const char* option, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
        names.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw InputError(fmt::format("{} {}", option, names[i]), "is given twice",
                       "give each name once");
    }
  }
}

std::vector<SessionFiles> parse_sessions(const std::vector<std::string>& texts) {
  std::vector<SessionFiles> sessions;
  std::vector<std::string> names;
  for (const std::string& text : texts) {
    sessions.push_back(parse_session(text));
    names.push_back(sessions.back().name);
  }
  refuse_repeated_names("--session", names);
  if (sessions.size() < 2) {
    throw InputError("--session", "one session cannot be compared", "give a second --session");
  }
  return sessions;
}

std::vector<std::string> recordings_of(const std::vector<SessionFiles>& sessions) {
  std::vector<std::string> recordings;
  for (const SessionFiles& session : sessions) {
    recordings.insert(recordings.end(), session.recordings.begin(), session.recordings.end());
  }
  return recordings;
}

std::vector<Session> sessions_of(const std::vector<SessionFiles>& files,
                                 std::vector<RecordingReport> reports) {
  std::vector<Session> sessions;
  auto next = std::make_move_iterator(reports.begin());
  for (const SessionFiles& session : files) {
    const auto end = next + static_cast<std::ptrdiff_t>(session.recordings.size());
    sessions.push_back({session.name, {next, end}});
    next = end;
  }
  return sessions;
}

}  // namespace condyle::host
