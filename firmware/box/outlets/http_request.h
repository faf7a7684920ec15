// SPDX-License-Identifier: Apache-2.0
// The box's HTTP interface, without the network.
//
//   GET  /                   the live page
//   GET  /v1/status          the state of the box (box_status.h)
//   GET  /v1/estimates       estimates as server-sent events, from now on; ?after=N or the header
//                            Last-Event-ID: from line N on, as far as it is still kept
//   GET  /v1/sessions        the recorded sessions (session_files.h)
//   GET  /v1/sessions/NAME   a session log; with /report after it, its report, where there is one
//   POST /v1/session/start   {"subject": "CODE"}, or {}
//   POST /v1/session/stop    {}
//   POST /v1/session/marker  {"text": "..."}
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace condyle::box {

/// Longest body accepted.
inline constexpr std::size_t kLongestBody = 4096;

/// A request as received; what was not sent is empty.
struct HttpRequest {
  std::string method, path;
  std::string host, authorization, content_type, last_event_id;
  std::string origin, fetch_site, fetch_mode;  ///< Origin, Sec-Fetch-Site, Sec-Fetch-Mode
  int hosts = 1;                               ///< Host headers
  std::optional<std::string> after;
  std::string body;
  bool is_too_long = false;  ///< the body; the rest of it was discarded
};

/// What a request must satisfy.
struct HttpAccess {
  std::string token;  ///< empty: any user of this machine has access
};

enum class HttpAction : std::uint8_t {
  refuse,
  page,
  status,
  estimates,
  sessions,
  log,
  report,
  start,
  stop,
  mark
};

/// What to do.
struct HttpRouting {
  HttpAction action = HttpAction::refuse;
  int status = 200;                    ///< of a refusal: 4xx
  std::string words;                   ///< why
  std::string text;                    ///< the subject, the text of the marker, or a log's name
  std::optional<std::uint64_t> after;  ///< absent: the newest
};

/// Without a token, only requests whose Host names this machine are accepted, so that no web page
/// can reach the box through a domain name of its own. Requests from pages of other sites are
/// refused by Origin and Sec-Fetch-Site, except for navigation to the box's own page. A POST must
/// be JSON, which such a page cannot send without permission.
HttpRouting route(const HttpRequest& request, const HttpAccess& access);

}  // namespace condyle::box
