// SPDX-License-Identifier: Apache-2.0
// A program to be killed: records reports into a log, and announces on standard output how many it
// has given to the writer, and how many of them the writer says are in the file.
// usage: recorder LOG 500Hz|AT_ONCE     (AT_ONCE: so many, then when they are written so many more)
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "condyle/hal/clock.h"
#include "support/session.h"

int main(int argc, char** argv) {
  if (argc != 3) return 1;
  const bool is_in_real_time = std::strcmp(argv[2], "500Hz") == 0;
  const auto at_once = static_cast<std::uint32_t>(std::atoi(argv[2]));
  const condyle::hal::SessionLogOptions usual;
  condyle::hal::SessionLogWriter log({.chunk_time_ns = is_in_real_time ? usual.chunk_time_ns : 0});
  if (log.open(argv[1], condyle::testing_support::make_header()) !=
      condyle::hal::SessionLogFailure::none) {
    return 1;
  }
  condyle::hal::SteadyClock clock;
  for (std::uint32_t number = 0; number < 10'000; ++number) {
    if (!log.write(0, condyle::testing_support::make_report(number, 29, clock.now_ns()))) return 1;
    const std::uint32_t announcement[] = {number + 1,
                                          static_cast<std::uint32_t>(log.status().reports_written)};
    if (write(STDOUT_FILENO, announcement, sizeof(announcement)) != sizeof(announcement)) return 1;
    if (is_in_real_time) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    } else if ((number + 1) % at_once == 0) {
      if (!condyle::testing_support::wait_until_written(log, number + 1)) return 1;
    }
  }
  return 1;  // nobody killed it
}
