// SPDX-License-Identifier: Apache-2.0
// condyle session believes a box alone, and waits for nobody without end.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "support/command.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::run_condyle;

// A server that sends the same to everybody, again and again where `repeats`, until they go.
class Stranger {
 public:
  explicit Stranger(std::string answer, std::string repeated = "")
      : answer_(std::move(answer)),
        repeated_(std::move(repeated)),
        listening_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    (void)bind(listening_, reinterpret_cast<const sockaddr*>(&address), size);
    (void)listen(listening_, 8);
    getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size);
    url_ = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    thread_ = std::thread([this] { serve(); });
  }
  ~Stranger() {
    stops_ = true;
    shutdown(listening_, SHUT_RDWR);
    thread_.join();
    close(listening_);
  }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

  const std::string& url() const { return url_; }

 private:
  void serve() {
    for (int peer = 0; (peer = accept(listening_, nullptr, nullptr)) >= 0;) {
      char request[4096];
      (void)!recv(peer, request, sizeof request, 0);
      const auto send_all = [peer](const std::string& text) {
        return send(peer, text.data(), text.size(), MSG_NOSIGNAL) ==
               static_cast<ssize_t>(text.size());
      };
      bool goes_on = send_all(answer_);
      while (goes_on && !repeated_.empty() && !stops_) goes_on = send_all(repeated_);
      close(peer);
    }
  }

  std::string answer_, repeated_, url_;
  int listening_;
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

CommandResult session(const std::string& url, const std::string& action) {
  return run_condyle({"session", action, "--box", url});
}

std::string answer(const std::string& body, const std::string& status = "200 OK") {
  return "HTTP/1.1 " + status + "\r\nContent-Length: " + std::to_string(body.size()) +
         "\r\nConnection: close\r\n\r\n" + body;
}

TEST(SessionCommand, BelievesABoxAlone) {
  for (const std::string& body :
       {std::string(), std::string("welcome"), std::string("[]"), std::string("{}"),
        std::string("{\"done\": 1}"), std::string("{\"format\": \"other\"}")}) {
    const Stranger stranger(answer(body));
    for (const char* action : {"start", "stop", "status"}) {
      const CommandResult result = session(stranger.url(), action);
      EXPECT_EQ(result.exit_code, 2) << body << action;
      EXPECT_THAT(result.errors, HasSubstr("the server at this address is not condyle-box"))
          << body;
      EXPECT_EQ(result.output, "") << body;
    }
  }
  const Stranger refuser(answer("<html>", "500 Internal"));
  EXPECT_THAT(session(refuser.url(), "stop").errors, HasSubstr("HTTP status 500 without JSON"));
}

TEST(SessionCommand, ShowsNothingThatMovesTheCursor) {
  const Stranger stranger(
      answer("{\"done\": \"\\u001b[2J\\nforged\", \"format\": "
             "\"condyle-box-status-1\", \"x\": \"\x1b[2J\"}"));
  for (const char* action : {"start", "status"}) {
    const CommandResult result = session(stranger.url(), action);
    EXPECT_THAT(result.output + result.errors,
                AllOf(Not(HasSubstr("\x1b")), Not(HasSubstr("\nforged"))));
  }
}

TEST(SessionCommand, TakesNoAnswerWithoutEnd) {
  const Stranger stranger("HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n{\"done\": \"",
                          std::string(65536, 'a'));
  for (const char* action : {"stop", "status"}) {
    const CommandResult result = session(stranger.url(), action);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.errors, HasSubstr("its answer is longer than 1 MiB"));
  }
}

TEST(SessionCommand, SaysThatNothingListens) {
  const CommandResult result = session("http://127.0.0.1:1", "status");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("no box answers: nothing listens there; start condyle-box"));
}

}  // namespace
}  // namespace condyle
