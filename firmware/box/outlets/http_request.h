// SPDX-License-Identifier: Apache-2.0
// What the box understands over HTTP, without the network.
//
//   GET  /                   a page that says what this is
//   GET  /v1/status          how the box does (box_status.h)
//   GET  /v1/estimates       estimates as server-sent events, from now on; ?after=N or the header
//                            Last-Event-ID: from line N on, as far as it is still kept
//   POST /v1/session/start   {"subject": "CODE"}, or {}
//   POST /v1/session/stop    {}
//   POST /v1/session/marker  {"text": "..."}
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace condyle::box {

/// Longest body taken.
inline constexpr std::size_t kLongestBody = 4096;

/// As it came in; what was not sent is empty.
struct HttpRequest {
  std::string method, path;
  std::string host, authorization, content_type, last_event_id;
  std::string origin, fetch_site, fetch_mode;  ///< Origin, Sec-Fetch-Site, Sec-Fetch-Mode
  int hosts = 1;                               ///< Host headers
  std::optional<std::string> after;
  std::string body;
  bool is_too_long = false;  ///< the body, of which the rest was thrown away
};

/// Who may ask.
struct HttpAccess {
  std::string token;  ///< empty: everybody on this machine
};

enum class HttpAction : std::uint8_t { refuse, page, status, estimates, start, stop, mark };

/// What is to be done.
struct HttpRouting {
  HttpAction action = HttpAction::refuse;
  int status = 200;                    ///< of a refusal: 4xx
  std::string words;                   ///< why
  std::string text;                    ///< the subject, or the marker
  std::optional<std::uint64_t> after;  ///< absent: the newest
};

/// Without a token only requests that name this machine are taken, so that no page in a browser can
/// reach the box through a name of its own. What a page of another site sends is refused by what
/// the browser says of it (Origin, Sec-Fetch-Site), but for a navigation to the box's own page. A
/// POST must be JSON, which such a page cannot send unasked.
HttpRouting route(const HttpRequest& request, const HttpAccess& access);

}  // namespace condyle::box
