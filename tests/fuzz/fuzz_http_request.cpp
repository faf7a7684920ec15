// SPDX-License-Identifier: Apache-2.0
// Any texts as a request, a line each, then the body: an answer, or a command that a stranger
// cannot have given.
#include <cctype>

#include "box/outlets/http_request.h"
#include "fuzz/lines.h"

namespace {

using namespace condyle;

void require(bool condition) {
  if (!condition) std::abort();
}

bool names_this_machine(std::string host) {
  for (char& c : host) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (host.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789.:[]") != std::string::npos) {
    return false;
  }
  return host.starts_with("localhost") || host.starts_with("127.") || host.starts_with("[");
}

void check(const box::HttpRequest& request, const box::HttpAccess& access) {
  const box::HttpRouting routing = box::route(request, access);
  if (routing.action == box::HttpAction::refuse) {
    require(routing.status >= 400 && routing.status < 500 && !routing.words.empty());
    fuzz::require_clean(routing.words);
    return;
  }
  require(routing.status == 200 && request.hosts <= 1);
  if (access.token.empty()) require(names_this_machine(request.host));
  if (routing.action == box::HttpAction::page) {
    require(request.path == "/" && request.method == "GET");
    return;
  }
  require(request.path.starts_with("/v1/"));
  require(request.fetch_site.empty() || request.fetch_site == "same-origin" ||
          request.fetch_site == "none");
  require(request.origin.empty() || request.origin == "http://" + request.host ||
          request.origin == "https://" + request.host);
  if (!access.token.empty()) require(request.authorization == "Bearer " + access.token);
  const bool is_file =
      routing.action == box::HttpAction::log || routing.action == box::HttpAction::report;
  const bool is_read = is_file || routing.action == box::HttpAction::status ||
                       routing.action == box::HttpAction::estimates ||
                       routing.action == box::HttpAction::sessions;
  // The name of a file in the folder, and of no other.
  if (is_file) {
    require(routing.text.ends_with(".mcap") && routing.text.find('/') == std::string::npos &&
            !routing.text.starts_with("."));
  }
  require(request.method == (is_read ? "GET" : "POST"));
  if (!is_read) require(request.content_type.starts_with("application/json"));
  require(routing.text.size() <= box::kLongestBody);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto lines = fuzz::parts(data, size, '\n', 11);
  box::HttpRequest request;
  request.method = lines[0];
  request.path = lines[1];
  request.host = lines[2];
  request.authorization = lines[3];
  request.content_type = lines[4];
  request.last_event_id = lines[5];
  request.origin = lines[6];
  request.fetch_site = lines[7];
  request.fetch_mode = lines[8];
  if (!lines[9].empty()) request.after = lines[9];
  request.body = lines[10];
  check(request, {});
  check(request, {"0123456789abcdef"});
  return 0;
}
