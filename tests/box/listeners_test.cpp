// SPDX-License-Identifier: Apache-2.0
// Who listens to the service over HTTP, and what comes that is no listener.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <random>
#include <vector>

#include "box/running_box.h"
#include "box/stream_reader.h"

namespace condyle::box {
namespace {

using testing::HasSubstr;
using testing_support::ask;
using testing_support::Connection;
using testing_support::EventStream;
using testing_support::get;
using testing_support::Listener;
using testing_support::RunningBox;
using testing_support::wait_for;
using Json = nlohmann::json;

// Whoever listens, however badly: nothing is dropped before the outlets, and who reads misses
// nothing.
TEST(Box, SlowAndDyingListenersHoldUpNobody) {
  RunningBox running;
  running.configuration.udp_port = 9;          // where nobody listens
  running.configuration.most_listeners = 100;  // also those whose end is not noticed yet
  running.listened = 0;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  Listener reads(running, "?after=0");
  const Connection never_reads(running.port);
  ASSERT_TRUE(never_reads.send("GET /v1/estimates HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  std::minstd_rand random(1);
  EventStream::Event event;
  std::uint64_t last = 0;
  for (int i = 0; i < 60; ++i) {
    Connection dies(running.port);
    ASSERT_TRUE(dies.send("GET /v1/estimates?after=0 HTTP/1.1\r\nHost: localhost\r\n\r\n"));
    for (auto parts = random() % 4; parts > 0; --parts) ASSERT_NE(dies.receive(), "");
    dies.abort();
    for (int k = 0; k < 10; ++k) {
      ASSERT_TRUE(reads.next(event));
      ASSERT_EQ(event.name, "");
      ASSERT_EQ(event.id, ++last);
    }
  }
  const Json status = running.status();
  EXPECT_EQ(status["outlets"]["dropped"], 0);
  EXPECT_EQ(status["device"]["reports_lost"], 0);
  EXPECT_TRUE(wait_for([&] { return running.status()["outlets"]["http_listeners"] <= 2; }));
}

TEST(Box, RefusesMoreListenersThanAllowed) {
  RunningBox running;
  running.configuration.most_listeners = 2;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  EventStream first(running.port), second(running.port);
  EventStream::Event event;
  ASSERT_TRUE(first.next(event) && second.next(event));
  const Connection third(running.port);
  (void)third.send("GET /v1/estimates HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(third.receive(), HasSubstr(" 503 "));
}

TEST(Box, OutlivesWhatIsNoHttp) {
  RunningBox running;
  running.start();
  const std::string host = "Host: localhost\r\n";
  const std::vector<std::string> requests = {
      "\r\n\r\n",
      "GET\r\n\r\n",
      "GET /v1/status\r\n\r\n",
      "GET /v1/status HTTP/9.9\r\n" + host + "\r\n",
      std::string("\0\xff\x01\r\n\r\n", 7),
      "GET /" + std::string(100'000, 'x') + " HTTP/1.1\r\n" + host + "\r\n",
      "GET /v1/status HTTP/1.1\r\n" + host + "X: " + std::string(100'000, 'x') + "\r\n\r\n",
      "POST /v1/session/stop HTTP/1.1\r\n" + host + "Content-Length: -5\r\n\r\n",
      "POST /v1/session/stop HTTP/1.1\r\n" + host + "Content-Length: 99999999999999999999\r\n\r\n",
      "POST /v1/session/stop HTTP/1.1\r\n" + host +
          "Content-Type: application/json\r\nContent-Length: 5000\r\n\r\n" + std::string(5000, 'x'),
      "POST /v1/session/stop HTTP/1.1\r\n" + host +
          "Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n",
      "GET /v1/status HTTP/1.1\r\n\r\n"};
  for (const std::string& request : requests) {
    Connection connection(running.port);
    ASSERT_TRUE(connection.is_open());
    (void)connection.send(request);
    connection.end_sending();
    const std::string answer = connection.receive();
    if (answer.starts_with("HTTP/1.")) {
      // 505 is what HTTP asks for where the version is not known.
      EXPECT_TRUE(answer[9] == '4' || answer.substr(9, 3) == "505")
          << request.substr(0, 60) << answer;
    }
  }
  std::minstd_rand random(1);
  for (int i = 0; i < 200; ++i) {
    std::string noise(random() % 2000, '\0');
    for (char& byte : noise) byte = static_cast<char>(random() >> 8U);
    (void)Connection(running.port).send(noise);
  }
  // Chunked, so that its size is not said before.
  std::string chunked = "POST /v1/session/stop HTTP/1.1\r\n" + host +
                        "Connection: close\r\nContent-Type: application/json\r\n"
                        "Transfer-Encoding: chunked\r\n\r\n";
  for (int i = 0; i < 100; ++i) chunked += "3e8\r\n" + std::string(1000, '{') + "\r\n";
  EXPECT_EQ(ask(running.port, chunked + "0\r\n\r\n").status, 413);
  EXPECT_EQ(get(running.port, "/v1/status").status, 200);
}

TEST(Box, AsksForItsToken) {
  RunningBox running;
  running.configuration.token = "0123456789abcdef";
  running.start();
  EXPECT_EQ(get(running.port, "/v1/status").status, 401);
  EXPECT_EQ(get(running.port, "/v1/status", "Authorization: Bearer 0123456789abcdee\r\n").status,
            401);
  EXPECT_EQ(get(running.port, "/v1/status", "Authorization: Bearer 0123456789abcdef\r\n").status,
            200);
}

// Wherever they come from: of an address, the oldest idle ones make room.
TEST(Box, OutlivesAThousandConnections) {
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = std::min<rlim_t>(files.rlim_max, 4096);
  setrlimit(RLIMIT_NOFILE, &files);
  // Both ends of each connection are in this process.
  if (files.rlim_cur < 2200) GTEST_SKIP() << "too few files may be open";
  for (const char* from : {"127.0.0.1", "127.0.0.2"}) {
    std::vector<Connection> idle;
    for (int i = 0; i < 1000; ++i) {
      idle.emplace_back(running.port, from);
      if (i % 100 != 99) continue;
      EXPECT_EQ(get(running.port, "/v1/status").status, 200) << from << i;
    }
    EXPECT_EQ(idle.front().receive(), "") << "the oldest is closed";
    EXPECT_TRUE(idle.back().send("GET /v1/status HTTP/1.0\r\nHost: localhost\r\n\r\n"));
    EXPECT_THAT(idle.back().receive(), HasSubstr("200 OK"));
  }
  EXPECT_EQ(running.status()["outlets"]["dropped"], 0);
}

// A request that comes a line at a time has ten seconds, as one that does not come at all.
TEST(Box, WaitsForNoSlowRequest) {
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  const auto begin = std::chrono::steady_clock::now();
  const Connection slow(running.port);
  ASSERT_TRUE(slow.send("GET /v1/status HTTP/1.1\r\nHost: localhost\r\n"));
  EXPECT_TRUE(wait_for([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    return !slow.send("X-Slow: 1\r\n");
  }));
  EXPECT_GT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(9));
}

TEST(Box, ServesAPageAndRefusesOtherSites) {
  RunningBox running;
  running.start();
  const auto with = [&](const std::string& path, const std::string& headers) {
    return ask(running.port, "GET " + path + " HTTP/1.0\r\n" + headers + "\r\n").status;
  };
  const std::string host = "Host: localhost\r\n";
  EXPECT_EQ(with("/", host), 200);
  EXPECT_THAT(get(running.port, "/").head, HasSubstr("frame-ancestors 'none'"));
  EXPECT_EQ(with("/", host + "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\n"), 200);
  for (const char* path : {"/v1/status", "/v1/estimates"}) {
    EXPECT_EQ(with(path, host + "Origin: http://evil.example\r\n"), 403);
    EXPECT_EQ(with(path, host + "Sec-Fetch-Site: cross-site\r\n"), 403);
    EXPECT_EQ(with(path, host + "Sec-Fetch-Site: same-site\r\n"), 403);
    EXPECT_EQ(with(path, "Host: localhost:evil\r\n"), 403);
    EXPECT_EQ(with(path, host + "Host: evil.example\r\n"), 400);
  }
  EXPECT_EQ(
      with("/v1/status", host + "Sec-Fetch-Site: same-origin\r\nOrigin: http://localhost\r\n"),
      200);
}

// A machine may get its address after it was switched on.
TEST(Box, ListensAtAnAddressThatComesLater) {
  RunningBox running;
  running.configuration.http_address = "192.0.2.1";
  running.configuration.token = std::string(32, 'x');
  running.start();
  EXPECT_NE(running.port, 0);
  EXPECT_TRUE(wait_for([&] { return running.box->status().is_found; }));
}

}  // namespace
}  // namespace condyle::box
