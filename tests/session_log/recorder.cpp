// SPDX-License-Identifier: Apache-2.0
// A program to be killed: records reports at about 500 Hz into the log named by its argument, and
// announces on standard output how many it has given to the writer, and how many of them the writer
// says are in the file.
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <thread>

#include "condyle/hal/clock.h"
#include "session_log/session.h"

int main(int argc, char** argv) {
  condyle::hal::SessionLogWriter log;
  if (argc != 2 || log.open(argv[1], condyle::testing_support::make_header()) !=
                       condyle::hal::SessionLogFailure::none) {
    return 1;
  }
  condyle::hal::SteadyClock clock;
  for (std::uint32_t number = 0; number < 10'000; ++number) {
    if (!log.write(0, condyle::testing_support::make_report(number, 29, clock.now_ns()))) return 1;
    const std::uint32_t announcement[] = {number + 1,
                                          static_cast<std::uint32_t>(log.status().reports_written)};
    if (write(STDOUT_FILENO, announcement, sizeof(announcement)) != sizeof(announcement)) return 1;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return 1;  // nobody killed it
}
