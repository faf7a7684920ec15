// SPDX-License-Identifier: Apache-2.0
// Requests that a program gone wrong, or a page of another site, sends to the running box.
#include <gmock/gmock.h>

#include <filesystem>

#include "box/running_box.h"

namespace condyle::box {
namespace {

using testing::HasSubstr;
using testing_support::ask;
using testing_support::Connection;
using testing_support::get;
using testing_support::post;
using testing_support::RunningBox;
using testing_support::wait_for;

constexpr const char* kJson = "Content-Type: application/json\r\n";

TEST(Requests, AreAnsweredHoweverManyArgumentsTheyHave) {
  RunningBox running;
  running.start();
  for (const int count : {100, 101, 600, 4000, 15'000}) {
    std::string path = "/v1/status?a";
    for (int i = 1; i < count; ++i) path += "&a";
    const auto answer = get(running.port, path);
    EXPECT_EQ(answer.status, count <= 100 ? 200 : 400) << count;
    if (count <= 100) continue;
    EXPECT_THAT(answer.body, HasSubstr("a request has 100 arguments at most"));
  }
  EXPECT_EQ(get(running.port, "/" + std::string(40'000, 'x')).status, 414);
}

TEST(Requests, WithTwoLengthsAreRefused) {
  RunningBox running;
  running.start();
  const std::string head = std::string("POST /v1/session/stop HTTP/1.1\r\nHost: localhost\r\n") +
                           "Connection: close\r\n" + kJson + "Content-Length: 2\r\n";
  EXPECT_EQ(ask(running.port, head + "\r\n{}").status, 409);
  EXPECT_EQ(ask(running.port, head + "Content-Length: 9\r\n\r\n{}").status, 400);
  EXPECT_EQ(
      ask(running.port, head + "Transfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n").status,
      400);
}

TEST(Requests, WithBrokenChunksAreAnswered) {
  RunningBox running;
  running.start();
  const std::string head = std::string("POST /v1/session/stop HTTP/1.1\r\nHost: localhost\r\n") +
                           kJson + "Transfer-Encoding: chunked\r\n\r\n";
  for (const char* body : {"zz\r\n{}\r\n", "-1\r\n{}\r\n", "2 x\r\n{}\r\n", "\r\n{}\r\n",
                           "2\r\n{}xx\r\n", "0x2\r\n{}\r\n"}) {
    EXPECT_EQ(ask(running.port, head + body).status, 400) << body;
  }
  EXPECT_EQ(ask(running.port, head + "ffffffffffffffffff\r\n{}\r\n").status, 413);
}

TEST(Requests, WithAnotherMethodAreRefused) {
  RunningBox running;
  running.start();
  for (const char* method : {"HEAD", "OPTIONS", "PUT", "TRACE", "CONNECT", "get"}) {
    for (const char* path : {"/v1/status", "/v1/estimates", "/v1/session/start"}) {
      const auto answer = ask(
          running.port, std::string(method) + " " + path + " HTTP/1.0\r\nHost: localhost\r\n\r\n");
      EXPECT_EQ(answer.status, 405) << method << path;
      EXPECT_EQ(answer.head.find("Access-Control"), std::string::npos);
    }
  }
}

// Where a token is set, nothing is said of what there is without it.
TEST(Requests, AllOfVersion1WantTheToken) {
  RunningBox running;
  running.configuration.token = "0123456789abcdef";
  running.start();
  for (const char* path : {"/v1/status", "/v1/estimates", "/v1/session/start", "/v1/session/stop",
                           "/v1/session/marker", "/v1/nothing", "/v1/", "/v1", "/other"}) {
    EXPECT_EQ(get(running.port, path).status, 401) << path;
    EXPECT_EQ(post(running.port, path, "{}").status, 401) << path;
  }
  EXPECT_EQ(get(running.port, "/").status, 200);
  EXPECT_EQ(post(running.port, "/", "{}").status, 401);
}

// One deadline for all of a request, however it drips.
TEST(Requests, HaveOneDeadline) {
  RunningBox running;
  running.start();
  const Connection body(running.port), silent(running.port), line(running.port);
  ASSERT_TRUE(body.send(std::string("POST /v1/session/stop HTTP/1.1\r\nHost: localhost\r\n") +
                        kJson + "Content-Length: 4000\r\n\r\n"));
  ASSERT_TRUE(line.send("GET /v1/sta"));
  EXPECT_TRUE(wait_for([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    return !body.send(" ");
  }));
  EXPECT_EQ(silent.receive(), "");
  EXPECT_EQ(line.receive(), "");
}

TEST(Requests, BeginNoThousandSessions) {
  RunningBox running(1);
  running.start();
  ASSERT_TRUE(running.is_estimating());
  int begun = 0, refused = 0;
  for (int i = 0; i < 200 && refused == 0; ++i) {
    const auto answer = post(running.port, "/v1/session/start", "{}");
    if (answer.status == 200) {
      ++begun;
      EXPECT_EQ(post(running.port, "/v1/session/stop", "{}").status, 200);
    } else if (answer.status == 429) {
      ++refused;
      EXPECT_THAT(answer.body, HasSubstr("sessions begin too often; wait ten seconds"));
      EXPECT_EQ(running.status()["session"]["phase"], "idle");
    }
  }
  EXPECT_GE(begun, 30);
  EXPECT_EQ(refused, 1);
  EXPECT_TRUE(
      wait_for([&] { return post(running.port, "/v1/session/start", "{}").status == 200; }));
}

TEST(Requests, BeginNoSessionBeforeTheClockIsSet) {
  RunningBox running;
  running.wall_offset_ns = -nanoseconds(86'400.0 * 365);
  running.start();
  ASSERT_TRUE(running.is_estimating());
  const auto answer = post(running.port, "/v1/session/start", "{}");
  EXPECT_EQ(answer.status, 503);
  EXPECT_THAT(answer.body, HasSubstr("this machine's clock is before 1970; set it"));
  running.wall_offset_ns = 0;
  EXPECT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
}

// Such a text would be lines of a replay's summary, or move a terminal's cursor.
TEST(Requests, MarkWithOneLineOfTextOnly) {
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  ASSERT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
  for (const char* text : {"x\\n  mass 0.2 +- 0.01 kg (95 %), measured", "\\u001b[2J", "\\r",
                           "\\u0000", "\\u0085", "\\u202e", "\\u2028", "\\ufeff"}) {
    const auto answer =
        post(running.port, "/v1/session/marker", std::string(R"({"text":")") + text + "\"}");
    EXPECT_EQ(answer.status, 400) << text;
    EXPECT_THAT(answer.body,
                HasSubstr("a marker must be one line of UTF-8 without control characters"));
  }
  EXPECT_EQ(post(running.port, "/v1/session/marker", R"({"text":"Bi\u00df, \"hart\""})").status,
            200);
}

// The name of a session may be that of a link that leads nowhere.
TEST(Requests, BeginASessionBesideADanglingLink) {
  RunningBox running;
  const std::string elsewhere = running.folder / "elsewhere";
  const std::time_t now = std::time(nullptr);
  for (std::time_t t = now; t < now + 900; ++t) {
    std::tm parts{};
    gmtime_r(&t, &parts);
    char name[40];
    std::strftime(name, sizeof name, "%Y%m%dT%H%M%SZ-S1.mcap", &parts);
    std::filesystem::create_symlink(elsewhere, running.folder / name);
  }
  running.start();
  ASSERT_TRUE(running.is_estimating());
  const auto answer = post(running.port, "/v1/session/start", R"({"subject":"S1"})");
  EXPECT_EQ(answer.status, 200) << answer.body;
  EXPECT_THAT(answer.body, HasSubstr("-S1-2.mcap"));
  EXPECT_EQ(post(running.port, "/v1/session/stop", "{}").status, 200);
  EXPECT_FALSE(std::filesystem::exists(elsewhere));
}

}  // namespace
}  // namespace condyle::box
