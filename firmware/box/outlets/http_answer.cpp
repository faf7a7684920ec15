// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/http_answer.h"

#include <strings.h>

#include <nlohmann/json.hpp>

#include "box/outlets/live_page.h"

namespace condyle::box {
namespace {

constexpr const char* kNothing = "default-src 'none'; frame-ancestors 'none'";

MHD_Result send(MHD_Connection* connection, int status, const std::string& body, const char* type,
                const char* content_policy = nullptr) {
  MHD_Response* const response = MHD_create_response_from_buffer(
      body.size(), const_cast<char*>(body.data()), MHD_RESPMEM_MUST_COPY);
  if (response == nullptr) return MHD_NO;
  add_headers(response, type, content_policy);
  if (status == MHD_HTTP_UNAUTHORIZED) {
    MHD_add_response_header(response, MHD_HTTP_HEADER_WWW_AUTHENTICATE, "Bearer");
  }
  if (status == MHD_HTTP_SERVICE_UNAVAILABLE) {
    MHD_add_response_header(response, MHD_HTTP_HEADER_RETRY_AFTER, "1");
  }
  const MHD_Result result = MHD_queue_response(connection, static_cast<unsigned>(status), response);
  MHD_destroy_response(response);
  return result;
}

}  // namespace

void add_headers(MHD_Response* response, const char* type, const char* content_policy) {
  MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE, type);
  MHD_add_response_header(response, "Content-Security-Policy",
                          content_policy != nullptr ? content_policy : kNothing);
  MHD_add_response_header(response, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
  MHD_add_response_header(response, "X-Content-Type-Options", "nosniff");
  MHD_add_response_header(response, "Referrer-Policy", "no-referrer");
  MHD_add_response_header(response, "Cross-Origin-Resource-Policy", "same-origin");
}

std::string header(MHD_Connection* connection, const char* name) {
  const char* const value = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, name);
  return value != nullptr ? value : "";
}

int count_headers(MHD_Connection* connection, const char* name) {
  struct Count {
    const char* name;
    int count = 0;
  } count{name};
  const auto add = [](void* self, MHD_ValueKind, const char* key, const char*) {
    auto& of = *static_cast<Count*>(self);
    if (strcasecmp(key, of.name) == 0) ++of.count;
    return MHD_YES;
  };
  MHD_get_connection_values(connection, MHD_HEADER_KIND, add, &count);
  return count.count;
}

MHD_Result send_json(MHD_Connection* connection, int status, const std::string& body) {
  return send(connection, status, body, "application/json");
}

std::string answer_json(const SessionRecorder::Answer& answer) {
  nlohmann::ordered_json json;
  json[answer.status < 400 ? "done" : "problem"] = answer.words;
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

MHD_Result send_page(MHD_Connection* connection) {
  const WebPage& page = live_page();
  return send(connection, MHD_HTTP_OK, page.text, "text/html; charset=utf-8",
              page.content_policy.c_str());
}

}  // namespace condyle::box
