// SPDX-License-Identifier: Apache-2.0
// Starts condyle-box or `condyle live`, records a session through its HTTP interface until no
// reports have come for IDLE_S; prints its last status and how its memory grew as one line of JSON.
// usage: drive_box IDLE_S|- PROGRAM [ARGUMENT...]
// With -, stops itself (SIGSTOP) once the session has begun, and ends when it is interrupted
// (SIGINT). The program chooses its port and prints it. Exit: the program's, or 3 where it did not
// do as told.
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "support/http_client.h"

namespace {

using namespace condyle::testing_support;
using Json = nlohmann::json;

constexpr int kExitNotAsTold = 3;
constexpr double kPeriod_s = 0.1;
constexpr std::int64_t kReportsToSettle = 30'000;  // by then everything that grows has grown

volatile std::sig_atomic_t is_interrupted = 0;

void sleep_s(double time_s) {
  std::this_thread::sleep_for(std::chrono::duration<double>(time_s));
}

class BoxProgram {
 public:
  explicit BoxProgram(char** words) {
    int ends[2];
    if (pipe(ends) != 0) std::abort();
    process_ = fork();
    if (process_ == 0) {
      dup2(ends[1], STDOUT_FILENO);
      dup2(ends[1], STDERR_FILENO);
      close(ends[0]);
      execv(words[0], words);
      _exit(127);
    }
    close(ends[1]);
    // What it says is passed on; one line of it tells the port.
    reader_ = std::thread([this, file = fdopen(ends[0], "r")] {
      char line[1024];
      while (std::fgets(line, sizeof line, file) != nullptr) {
        std::fputs(line, stderr);
        for (const std::string before : {" port ", "http://127.0.0.1:"}) {
          if (const char* const at = std::strstr(line, before.c_str())) {
            port_ = std::atoi(at + before.size());
          }
        }
      }
      std::fclose(file);
      has_ended_ = true;
    });
  }

  std::uint16_t port() const {
    while (port_ == 0 && !has_ended_) sleep_s(0.01);
    return static_cast<std::uint16_t>(port_);
  }
  bool has_ended() const { return has_ended_; }
  // Bytes in RAM.
  std::int64_t memory_bytes() const {
    std::ifstream file("/proc/" + std::to_string(process_) + "/statm");
    std::int64_t whole = 0, resident = 0;
    file >> whole >> resident;
    return resident * sysconf(_SC_PAGESIZE);
  }
  int end() {
    int status = 0;
    kill(process_, SIGTERM);
    waitpid(process_, &status, 0);
    reader_.join();
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  pid_t process_ = -1;
  std::atomic<int> port_ = 0;
  std::atomic<bool> has_ended_ = false;
  std::thread reader_;
};

Json status_of(std::uint16_t port) {
  return Json::parse(get(port, "/v1/status").body, nullptr, false);
}

bool has_estimates_to_publish(const Json& status) {
  const std::int64_t estimates = status["estimator"]["estimates"];
  const std::int64_t published = status["outlets"]["published"],
                     dropped = status["outlets"]["dropped"];
  return published + dropped < estimates;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: drive_box IDLE_S|- PROGRAM [ARGUMENT...]\n");
    return 2;
  }
  const bool stops_itself = std::strcmp(argv[1], "-") == 0;
  const double idle_s = stops_itself ? HUGE_VAL : std::strtod(argv[1], nullptr);
  std::signal(SIGINT, [](int) { is_interrupted = 1; });
  BoxProgram program(argv + 2);
  const std::uint16_t port = program.port();
  // Until the facebow is found.
  bool is_as_told = false;
  while (!is_as_told && !program.has_ended()) {
    is_as_told = post(port, "/v1/session/start", R"({"subject":"HIL"})").status == 200;
    if (!is_as_told) sleep_s(0.02);
  }
  if (is_as_told && stops_itself) raise(SIGSTOP);
  std::int64_t received = 0, settled_bytes = 0, last_bytes = 0;
  for (double silent_s = 0; is_as_told && is_interrupted == 0 && silent_s < idle_s;) {
    sleep_s(kPeriod_s);
    const Json status = status_of(port);
    if (!status.is_object()) {
      is_as_told = false;
      break;
    }
    const std::int64_t now = status["device"]["reports_received"];
    // Before the first one the device is still being plugged in.
    silent_s = now == received && now > 0 ? silent_s + kPeriod_s : 0;
    received = now;
    last_bytes = program.memory_bytes();
    if (received >= kReportsToSettle && settled_bytes == 0) settled_bytes = last_bytes;
  }
  is_as_told = is_as_told && post(port, "/v1/session/stop", "{}").status == 200;
  Json status = status_of(port);
  while (is_as_told && has_estimates_to_publish(status)) {
    sleep_s(0.01);
    status = status_of(port);
  }
  const int exit_code = program.end();
  status["grown_bytes"] = settled_bytes > 0 ? last_bytes - settled_bytes : 0;
  std::printf("%s\n", status.dump().c_str());
  return exit_code == 0 && !is_as_told ? kExitNotAsTold : exit_code;
}
