// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/http_request.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <string_view>

#include "box/configuration.h"
#include "box/recording/session_file_name.h"

namespace condyle::box {
namespace {

HttpRouting refusal(int status, const char* words) {
  return {.action = HttpAction::refuse, .status = status, .words = words, .text = {}, .after = {}};
}

// Takes the same time for every wrong token of the same length.
bool is_same(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |=
        static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  }
  return difference == 0;
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// HOST or HOST:PORT, nothing else; names in either case, with or without the dot at the end.
bool names_this_machine(const std::string& text) {
  std::string_view host = text, rest;
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    if (end == std::string_view::npos) return false;
    rest = host.substr(end + 1);
    host = host.substr(1, end - 1);
    if (host.find(':') == std::string_view::npos) return false;
  } else {
    const std::size_t colon = std::min(host.find(':'), host.size());
    rest = host.substr(colon);
    host = host.substr(0, colon);
  }
  if (!rest.empty() && (rest.front() != ':' || !is_port(rest.substr(1)))) return false;
  std::string name(host);
  for (char& c : name) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  if (name == "localhost" || name == "localhost.") return true;
  return is_loopback(name);
}

// True for requests that a browser marks as made by a page of another site.
bool is_of_another_site(const HttpRequest& request) {
  const std::string& site = request.fetch_site;
  if (!site.empty() && site != "same-origin" && site != "none") return true;
  const std::string& origin = request.origin;
  return !origin.empty() && origin != "http://" + request.host &&
         origin != "https://" + request.host;
}

bool is_json(const std::string& content_type) {
  std::string type = content_type.substr(0, content_type.find(';'));
  while (!type.empty() && type.back() == ' ') type.pop_back();
  return type == "application/json";
}

std::optional<std::uint64_t> number(const std::string& text) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [place, error] = std::from_chars(text.data(), end, value);
  if (text.empty() || error != std::errc() || place != end) return {};
  return value;
}

HttpRouting route_estimates(const HttpRequest& request) {
  HttpRouting routing{
      .action = HttpAction::estimates, .status = 200, .words = {}, .text = {}, .after = {}};
  const std::string asked = request.after ? *request.after : request.last_event_id;
  if (!request.after && asked.empty()) return routing;
  routing.after = number(asked);
  if (!routing.after) return refusal(400, "after and Last-Event-ID must be numbers of estimates");
  return routing;
}

constexpr std::string_view kSessions = "/v1/sessions/", kReport = "/report";

// A log or its report.
HttpRouting route_recording(const HttpRequest& request) {
  std::string_view name = std::string_view(request.path).substr(kSessions.size());
  const bool is_report = name.ends_with(kReport);
  if (is_report) name.remove_suffix(kReport.size());
  if (!is_session_file(name)) return refusal(404, "not the name of a session log");
  return {.action = is_report ? HttpAction::report : HttpAction::log,
          .status = 200,
          .words = {},
          .text = std::string(name),
          .after = {}};
}

// The text of the body's only key.
HttpRouting route_command(const HttpRequest& request, HttpAction action, const char* key,
                          bool is_needed) {
  if (request.is_too_long) return refusal(413, "a request may have at most 4096 bytes");
  if (!is_json(request.content_type)) {
    return refusal(415, "send JSON, with Content-Type: application/json");
  }
  const nlohmann::json json = nlohmann::json::parse(request.body, nullptr, false);
  if (!json.is_object()) return refusal(400, "the body is not a JSON object");
  HttpRouting routing{.action = action, .status = 200, .words = {}, .text = {}, .after = {}};
  for (const auto& [name, value] : json.items()) {
    if (name != key || !value.is_string()) {
      HttpRouting wrong = refusal(400, "");
      wrong.words = std::string("the body may contain ") +
                    (key[0] == '\0' ? "nothing" : std::string("one text, \"") + key + "\"");
      return wrong;
    }
    routing.text = value.get<std::string>();
  }
  if (is_needed && routing.text.empty()) {
    HttpRouting missing = refusal(400, "");
    missing.words = std::string("the body has no \"") + key + "\"";
    return missing;
  }
  return routing;
}

}  // namespace

HttpRouting route(const HttpRequest& request, const HttpAccess& access) {
  if (request.hosts > 1) return refusal(400, "a request must have exactly one Host header");
  const bool is_page = request.path == "/" && request.method == "GET";
  const bool is_navigation = is_page && request.origin.empty() && request.fetch_mode == "navigate";
  if (is_of_another_site(request) && !is_navigation) {
    return refusal(403, "pages of other sites may not use the box");
  }
  if (is_page && (!access.token.empty() || names_this_machine(request.host))) {
    return {.action = HttpAction::page, .status = 200, .words = {}, .text = {}, .after = {}};
  }
  if (!access.token.empty()) {
    if (!is_same(request.authorization, "Bearer " + access.token)) {
      return refusal(401, "send the box's token as Authorization: Bearer TOKEN");
    }
  } else if (!names_this_machine(request.host)) {
    return refusal(403, "the Host header does not name this machine");
  }
  const bool is_get = request.method == "GET", is_post = request.method == "POST";
  const std::string& path = request.path;
  const bool is_command =
      path == "/v1/session/start" || path == "/v1/session/stop" || path == "/v1/session/marker";
  const bool is_recording = path.starts_with(kSessions);
  if (path != "/v1/status" && path != "/v1/estimates" && path != "/v1/sessions" && !is_recording &&
      !is_command) {
    return refusal(404,
                   "not found; use /v1/status, /v1/estimates, /v1/sessions, or /v1/session/ with "
                   "start, stop or "
                   "marker");
  }
  if (is_command ? !is_post : !is_get) {
    return refusal(405, is_command ? "use POST" : "use GET");
  }
  if (path == "/v1/status") {
    return {.action = HttpAction::status, .status = 200, .words = {}, .text = {}, .after = {}};
  }
  if (path == "/v1/sessions") {
    return {.action = HttpAction::sessions, .status = 200, .words = {}, .text = {}, .after = {}};
  }
  if (is_recording) return route_recording(request);
  if (path == "/v1/estimates") return route_estimates(request);
  if (path == "/v1/session/start")
    return route_command(request, HttpAction::start, "subject", false);
  if (path == "/v1/session/stop") return route_command(request, HttpAction::stop, "", false);
  return route_command(request, HttpAction::mark, "text", true);
}

}  // namespace condyle::box
