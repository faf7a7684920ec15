// SPDX-License-Identifier: Apache-2.0
// A long session in the box, in less time than it takes: 500 reports a second of a clock that runs
// faster, as many chunks in the log as in real time, true files, of which finished ones are
// deleted. Memory stays within 1 MB of that after the first 24th of the session, no descriptor is
// left over, and every report is recorded or counted. usage: day_in_the_box [HOURS [SPEED]]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <string>
#include <thread>

#include "box/running_box.h"
#include "support/resident_memory.h"

namespace {

using namespace condyle;
using testing_support::resident_MB;
using testing_support::RunningBox;

// While a log follows another, both are open, on a busy machine for seconds: so it waits until no
// more than `expected` are.
std::ptrdiff_t descriptors(std::ptrdiff_t expected) {
  std::ptrdiff_t least = 1'000'000;
  for (int i = 0; i < 10 || (i < 4000 && least > expected); ++i) {
    const std::filesystem::directory_iterator begin("/proc/self/fd"), end;
    least = std::min(least, std::distance(begin, end));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return least;
}

// Not the youngest ones: a part begins before the status names its file.
std::uint64_t delete_finished(const std::filesystem::path& folder, const std::string& written) {
  const auto youngest = std::filesystem::file_time_type::clock::now() - std::chrono::seconds(10);
  std::uint64_t bytes = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    if (file.path().string() == written || file.last_write_time() > youngest) continue;
    bytes += file.file_size();
    std::filesystem::remove(file.path());
  }
  return bytes;
}

int fail(const std::string& words) {
  std::printf("day_in_the_box: %s\n", words.c_str());
  return 1;
}

int run(double hours, double speed) {
  const auto begin = std::chrono::steady_clock::now();
  const testing_support::TemporaryFolder folder;
  RunningBox running(speed);
  running.configuration.folder = folder.path().string();
  running.configuration.priority = 0;
  running.configuration.log.chunk_time_ns =
      static_cast<TimeNs>(static_cast<double>(running.configuration.log.chunk_time_ns) / speed);
  running.start();
  if (!running.is_estimating()) return fail("there are no estimates");
  if (testing_support::post(running.port, "/v1/session/start", "{}").status != 200) {
    return fail("the session did not start");
  }
  const TimeNs begin_ns = running.clock.now_ns();
  const TimeNs length_ns = nanoseconds(hours * 3600), step_ns = length_ns / 24;
  double first_MB = 0, most_MB = 0;
  std::ptrdiff_t first_descriptors = 0, most_descriptors = 0;
  std::uint64_t bytes = 0, chunks = 0, chunks_of_part = 0;
  TimeNs next_ns = step_ns;
  std::printf("%8s %10s %11s %5s %10s %8s\n", "hours", "memory MB", "descriptors", "part",
              "reports", "took s");
  for (;;) {
    const TimeNs now_ns = running.clock.now_ns() - begin_ns;
    const box::SessionState session = running.box->status().session;
    if (session.phase != box::SessionState::Phase::recording) return fail(session.problem);
    if (session.log.chunks_written < chunks_of_part) chunks += chunks_of_part;
    chunks_of_part = session.log.chunks_written;
    bytes += delete_finished(folder.path(), session.file);
    const double now_MB = resident_MB();
    if (first_MB > 0) most_MB = std::max(most_MB, now_MB);
    if (now_ns >= next_ns) {
      // The first hour ends far from a change of files.
      const std::ptrdiff_t open = descriptors(first_MB == 0 ? 1'000'000 : first_descriptors);
      if (first_MB == 0) {
        first_MB = most_MB = now_MB;
        first_descriptors = open;
      }
      most_descriptors = std::max(most_descriptors, open);
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
      std::printf("%8.2f %10.2f %11td %5d %10llu %8.0f\n", seconds(now_ns) / 3600, now_MB, open,
                  session.part, static_cast<unsigned long long>(session.reports_received),
                  took.count());
      std::fflush(stdout);
      next_ns += step_ns;
    }
    if (now_ns >= length_ns) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  if (testing_support::post(running.port, "/v1/session/stop", "{}").status != 200) {
    return fail("the session did not stop");
  }
  const box::SessionState session = running.box->status().session;
  std::printf("%llu reports in %d parts, %llu lost; %llu chunks; %.0f MB of finished parts\n",
              static_cast<unsigned long long>(session.reports_written), session.part,
              static_cast<unsigned long long>(session.reports_lost),
              static_cast<unsigned long long>(chunks + session.log.chunks_written),
              static_cast<double>(bytes) * 1e-6);
  std::printf("memory: %.2f MB, later at most %.2f MB\n", first_MB, most_MB);
  if (session.reports_received != session.reports_written + session.reports_lost) {
    return fail(std::to_string(session.reports_received) + " reports were received");
  }
  if (most_MB > first_MB + 1) return fail("memory has grown by more than 1 MB");
  if (most_descriptors > first_descriptors) return fail("descriptors are left over");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const double hours = argc > 1 ? std::atof(argv[1]) : 24;
  const double speed = argc > 2 ? std::atof(argv[2]) : 100;
  if (argc > 3 || !(hours > 0) || !(speed >= 1)) {
    std::fputs("usage: day_in_the_box [HOURS [SPEED]]\n", stderr);
    return 2;
  }
  return run(hours, speed);
}
