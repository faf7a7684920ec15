// SPDX-License-Identifier: Apache-2.0
// Writes a session log whose device was unplugged: the reports of another log, a disconnection, and
// a second later the same reports again, counter and clock from the start, as its profile then
// says. usage: unplug_log LOG OUT
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "condyle/hal/log/session_log.h"
#include "condyle/hal/log/session_log_source.h"

namespace {

using namespace condyle;

constexpr TimeNs kAway_ns = kNanosecondsPerSecond;

// Waits for room in the log.
template <class Write>
void insist(Write write) {
  while (!write()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

bool say_restarts(std::string& profile_toml) {
  const std::string before = "restarts_on_reconnect = false";
  const std::size_t place = profile_toml.find(before);
  if (place == std::string::npos) return false;
  profile_toml.replace(place, before.size(), "restarts_on_reconnect = true");
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: unplug_log LOG OUT\n");
    return 2;
  }
  hal::SessionLogSource first(argv[1]), again(argv[1]);
  if (first.open() != hal::Status::ok || again.open() != hal::Status::ok) {
    std::fprintf(stderr, "unplug_log: %s: no session log\n", argv[1]);
    return 2;
  }
  hal::SessionHeader header = first.header();
  if (!say_restarts(header.sources.front().profile_toml)) {
    std::fprintf(stderr, "unplug_log: %s: its profile does not say restarts_on_reconnect\n",
                 argv[1]);
    return 2;
  }
  hal::SessionLogWriter log;
  if (log.open(argv[2], header) != hal::SessionLogFailure::none) {
    std::fprintf(stderr, "unplug_log: %s cannot be written\n", argv[2]);
    return 2;
  }
  hal::RawReport report;
  TimeNs begin_ns = 0, end_ns = 0;
  int reports = 0;
  while (first.read(0, report) == hal::Status::ok) {
    if (reports++ == 0) begin_ns = report.host_time_ns;
    end_ns = report.host_time_ns;
    insist([&] { return log.write(0, report); });
  }
  insist([&] { return log.write_event(0, end_ns, hal::SessionEvent::disconnected, ""); });
  const TimeNs later_ns = end_ns - begin_ns + kAway_ns;
  insist([&] { return log.write_event(0, begin_ns + later_ns, hal::SessionEvent::connected, ""); });
  while (again.read(0, report) == hal::Status::ok) {
    report.host_time_ns += later_ns;
    insist([&] { return log.write(0, report); });
  }
  if (log.close() != hal::SessionLogFailure::none) return 1;
  std::printf("%d reports twice, the device unplugged between them\n", reports);
  return reports > 0 ? 0 : 1;
}
