// SPDX-License-Identifier: Apache-2.0
// A recorder killed at any moment leaves a log that opens, has all that the writer said was
// written, and lacks at most the last 300 ms, which only real time can show.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <random>
#include <thread>

#include "support/paths.h"
#include "support/read_log.h"
#include "support/session.h"
#include "support/temporary_folder.h"
#include "support/tier.h"

extern char** environ;

namespace condyle {
namespace {

using Clock = std::chrono::steady_clock;
using testing_support::Tier;
using testing_support::tier_is_at_least;

// A running recorder and what it announces.
class Recorder {
 public:
  // `pace`: see recorder.cpp.
  Recorder(std::string log_path, std::string pace) : log_path_(std::move(log_path)) {
    int ends[2] = {};
    EXPECT_EQ(pipe2(ends, O_CLOEXEC), 0);
    fcntl(ends[0], F_SETPIPE_SZ, 4096);  // so that it does not run far ahead
    output_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::string program = testing_support::program_path("session_recorder");
    char* const arguments[] = {program.data(), log_path_.data(), pace.data(), nullptr};
    EXPECT_EQ(posix_spawn(&process_, program.c_str(), &actions, nullptr, arguments, environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
  }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  ~Recorder() { ::close(output_); }

  // Numbers of reports: given to the writer, and in the file as the writer says.
  struct Announcement {
    std::uint32_t given = 0, written = 0;
  };

  bool wait_for_report(std::uint32_t number) {
    while (last_.given < number) {
      if (!take_announcement()) return false;
    }
    return true;
  }
  // Kills it and gives what it announced last.
  Announcement kill_it() {
    kill(process_, SIGKILL);
    int state = 0;
    waitpid(process_, &state, 0);
    EXPECT_TRUE(WIFSIGNALED(state));
    while (take_announcement()) {
    }
    return last_;
  }
  const std::string& log_path() const { return log_path_; }

 private:
  bool take_announcement() {
    static_assert(sizeof(Announcement) == 8);
    return read(output_, &last_, sizeof(last_)) == sizeof(last_);
  }

  std::string log_path_;
  int output_ = -1;
  pid_t process_ = -1;
  Announcement last_;
};

// Whole and in order, and what the writer said was written is in it; the number of reports missing.
std::uint32_t check_killed(Recorder& recorder) {
  const Recorder::Announcement announced = recorder.kill_it();
  const auto log = testing_support::read_log(recorder.log_path());
  EXPECT_EQ(log.opened, hal::Status::ok);
  if (log.opened != hal::Status::ok) return 0;
  EXPECT_EQ(log.condition.outcome, hal::McapRead::truncated);
  const auto& reports = log.reports[0];
  for (std::uint32_t number = 0; number < reports.size(); ++number) {
    const hal::RawReport& report = reports[number];
    EXPECT_TRUE(testing_support::is_same(
        report, testing_support::make_report(number, 29, report.host_time_ns)))
        << number;
  }
  // One may have been given without having been announced.
  EXPECT_LE(reports.size(), announced.given + 1);
  EXPECT_GE(reports.size(), announced.written);
  const auto found = static_cast<std::uint32_t>(reports.size());
  return announced.given > found ? announced.given - found : 0;
}

// Ten recorders at once, five times.
TEST(KilledRecorder, HasAllThatWasWritten) {
  const testing_support::TemporaryFolder folder;
  for (std::uint32_t round = 0; round < 5; ++round) {
    std::minstd_rand random(round + 1);
    std::vector<std::unique_ptr<Recorder>> recorders;
    for (int i = 0; i < 10; ++i) {
      const std::string name = std::to_string(round) + "_" + std::to_string(i) + ".mcap";
      recorders.push_back(std::make_unique<Recorder>(folder / name, "100"));
    }
    for (const auto& recorder : recorders) {
      ASSERT_TRUE(recorder->wait_for_report(static_cast<std::uint32_t>(1 + random() % 1'000)));
      (void)check_killed(*recorder);
    }
  }
}

// Five recorders at once, ten times. How much is missing is judged by the count of reports, which
// come no faster than every 2 ms.
TEST(KilledRecorder, LosesAtMostTheLast300ms) {
  if (!tier_is_at_least(Tier::release)) {
    GTEST_SKIP() << "judges a reaction in real time: set CONDYLE_TIER=release";
  }
  constexpr std::uint32_t kReportsIn300ms = 150;
  const testing_support::TemporaryFolder folder;
  std::uint32_t most_missing = 0;
  for (std::uint32_t round = 0; round < 10; ++round) {
    std::minstd_rand random(round + 1);
    std::vector<std::unique_ptr<Recorder>> recorders;
    std::vector<std::chrono::milliseconds> moments;
    for (int i = 0; i < 5; ++i) {
      const std::string name = std::to_string(round) + "_" + std::to_string(i) + ".mcap";
      recorders.push_back(std::make_unique<Recorder>(folder / name, "500Hz"));
      moments.emplace_back(random() % 1'300);
    }
    for (const auto& recorder : recorders) ASSERT_TRUE(recorder->wait_for_report(1));
    std::sort(moments.begin(), moments.end());
    const Clock::time_point start = Clock::now();
    for (std::size_t i = 0; i < recorders.size(); ++i) {
      std::this_thread::sleep_until(start + moments[i]);
      most_missing = std::max(most_missing, check_killed(*recorders[i]));
    }
  }
  std::printf("50 logs opened; at most %u reports (at most one every 2 ms) missing\n",
              most_missing);
  EXPECT_LE(most_missing, kReportsIn300ms);
}

}  // namespace
}  // namespace condyle
