// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/http_request.h"

#include <gtest/gtest.h>

namespace condyle::box {
namespace {

HttpRequest request(const std::string& method, const std::string& path,
                    const std::string& body = "") {
  HttpRequest made;
  made.method = method;
  made.path = path;
  made.host = "localhost:8750";
  made.content_type = "application/json";
  made.body = body;
  return made;
}

int refused(const HttpRequest& asked, const HttpAccess& access = {}) {
  const HttpRouting routing = route(asked, access);
  EXPECT_FALSE(routing.action == HttpAction::refuse && routing.words.empty());
  return routing.action == HttpAction::refuse ? routing.status : 0;
}

TEST(HttpRequest, KnowsWhatThereIs) {
  EXPECT_EQ(route(request("GET", "/v1/status"), {}).action, HttpAction::status);
  EXPECT_EQ(route(request("POST", "/v1/session/stop", "{}"), {}).action, HttpAction::stop);
  const HttpRouting start = route(request("POST", "/v1/session/start", R"({"subject":"S1"})"), {});
  EXPECT_EQ(start.action, HttpAction::start);
  EXPECT_EQ(start.text, "S1");
  EXPECT_EQ(route(request("POST", "/v1/session/start", "{}"), {}).action, HttpAction::start);
  const HttpRouting mark = route(request("POST", "/v1/session/marker", R"({"text":"bite"})"), {});
  EXPECT_EQ(mark.action, HttpAction::mark);
  EXPECT_EQ(mark.text, "bite");

  EXPECT_EQ(route(request("GET", "/v1/sessions"), {}).action, HttpAction::sessions);
  const HttpRouting log = route(request("GET", "/v1/sessions/20260101T120000Z-P1.mcap"), {});
  EXPECT_EQ(log.action, HttpAction::log);
  EXPECT_EQ(log.text, "20260101T120000Z-P1.mcap");
  const HttpRouting report = route(request("GET", "/v1/sessions/a.mcap/report"), {});
  EXPECT_EQ(report.action, HttpAction::report);
  EXPECT_EQ(report.text, "a.mcap");

  EXPECT_EQ(refused(request("GET", "/v1/nothing")), 404);
  EXPECT_EQ(refused(request("GET", "/v1/sessions/../box.toml")), 404);
  EXPECT_EQ(refused(request("GET", "/v1/sessions//a.mcap")), 404);
  EXPECT_EQ(refused(request("POST", "/v1/sessions/a.mcap", "{}")), 405);
  EXPECT_EQ(refused(request("GET", "/v1/session/start")), 405);
  EXPECT_EQ(refused(request("POST", "/v1/status", "{}")), 405);
  EXPECT_EQ(refused(request("DELETE", "/v1/estimates")), 405);
}

TEST(HttpRequest, KnowsThisMachineByItsNamesAlone) {
  for (const char* host : {"localhost", "LOCALHOST:8750", "localhost.", "127.0.0.1:1", "127.1.2.3",
                           "[::1]", "[::1]:8750"}) {
    HttpRequest asked = request("GET", "/v1/status");
    asked.host = host;
    EXPECT_EQ(refused(asked), 0) << host;
  }
  for (const char* host :
       {"", "evil.example", "[::1].evil.com", "localhost:evil", "localhost:", "localhost:123456",
        "localhost.evil.com", "[127.0.0.1]", "[::1", "localhost:1:2", "127.0.0.1.evil.com"}) {
    HttpRequest asked = request("GET", "/v1/status");
    asked.host = host;
    EXPECT_EQ(refused(asked), 403) << host;
  }
}

// What a browser says of a page of another site, with a token and without.
TEST(HttpRequest, RefusesOtherSites) {
  for (const char* token : {"", "0123456789abcdef"}) {
    const HttpAccess access{token};
    for (const char* path : {"/v1/status", "/v1/estimates", "/v1/sessions", "/v1/sessions/a.mcap",
                             "/v1/sessions/a.mcap/report", "/"}) {
      HttpRequest asked = request("GET", path);
      asked.authorization = std::string("Bearer ") + token;
      EXPECT_EQ(refused(asked, access), 0) << path;
      asked.fetch_site = "cross-site";
      EXPECT_EQ(refused(asked, access), 403) << path;
      asked.fetch_mode = "navigate";
      EXPECT_EQ(refused(asked, access), std::string(path) == "/" ? 0 : 403) << path;
      asked.fetch_site = "same-origin";
      EXPECT_EQ(refused(asked, access), 0) << path;
      asked.origin = "http://localhost:8750";
      EXPECT_EQ(refused(asked, access), 0) << path;
      for (const char* origin : {"null", "http://evil.example", "http://localhost:9000"}) {
        asked.origin = origin;
        EXPECT_EQ(refused(asked, access), 403) << path << origin;
      }
    }
  }
  HttpRequest twice = request("GET", "/v1/status");
  twice.hosts = 2;
  EXPECT_EQ(refused(twice), 400);
}

TEST(HttpRequest, TakesOnlyTheBodyItAskedFor) {
  for (const char* body : {"", "[]", "1", "{", R"({"subject":1})", R"({"name":"x"})",
                           R"({"subject":"a","b":"c"})", "{\"subject\":\"\xff\"}"}) {
    EXPECT_EQ(refused(request("POST", "/v1/session/start", body)), 400) << body;
  }
  EXPECT_EQ(refused(request("POST", "/v1/session/stop", R"({"x":"y"})")), 400);
  EXPECT_EQ(refused(request("POST", "/v1/session/marker", "{}")), 400);
  HttpRequest form = request("POST", "/v1/session/stop", "{}");
  form.content_type = "text/plain";
  EXPECT_EQ(refused(form), 415);
  form.content_type = "application/json; charset=utf-8";
  EXPECT_EQ(refused(form), 0);
  form.is_too_long = true;
  EXPECT_EQ(refused(form), 413);
}

TEST(HttpRequest, GoesOnWhereAListenerStopped) {
  HttpRequest listen = request("GET", "/v1/estimates");
  EXPECT_FALSE(route(listen, {}).after.has_value());
  listen.last_event_id = "41";
  EXPECT_EQ(route(listen, {}).after, 41U);
  listen.after = "7";
  EXPECT_EQ(route(listen, {}).after, 7U);
  for (const char* wrong : {"", "-1", "x", "1 ", "99999999999999999999"}) {
    listen.after = wrong;
    EXPECT_EQ(refused(listen), 400) << wrong;
  }
}

// A page in a browser may be led to this machine by a name of its own.
TEST(HttpRequest, WithoutATokenAnswersThisMachineOnly) {
  HttpRequest asked = request("GET", "/v1/status");
  for (const char* host : {"localhost", "127.0.0.1:8750", "127.9.9.9", "[::1]:8750", "[::1]"}) {
    asked.host = host;
    EXPECT_EQ(refused(asked), 0) << host;
  }
  for (const char* host : {"", "evil.example", "10.0.0.1", "localhost.evil.example", "[::2]", "[",
                           "127.0.0.1.evil.example"}) {
    asked.host = host;
    EXPECT_EQ(refused(asked), 403) << host;
  }
}

TEST(HttpRequest, WithATokenAnswersWhoHasIt) {
  const HttpAccess access{"0123456789abcdef"};
  HttpRequest asked = request("GET", "/v1/status");
  asked.host = "box.example";
  for (const char* wrong : {"", "Bearer ", "0123456789abcdef", "Bearer 0123456789abcdeF",
                            "Bearer 0123456789abcdef0", "bearer 0123456789abcdef"}) {
    asked.authorization = wrong;
    EXPECT_EQ(refused(asked, access), 401) << wrong;
  }
  asked.authorization = "Bearer 0123456789abcdef";
  EXPECT_EQ(refused(asked, access), 0);
}

}  // namespace
}  // namespace condyle::box
