// SPDX-License-Identifier: Apache-2.0
#include "output/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace condyle::host {
namespace {
constexpr TimeNs kFirst_ns = kNanosecondsPerSecond;
constexpr TimeNs kEvery_ns = kNanosecondsPerSecond / 5;
}  // namespace

Progress::Progress(std::string what, hal::Clock& clock, unsigned calls_between_looks)
    : what_(std::move(what)),
      clock_(clock),
      is_terminal_(isatty(STDERR_FILENO) != 0),
      calls_between_looks_(calls_between_looks),
      next_ns_(clock.now_ns() + kFirst_ns) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\x1b[K", stderr);
}

void Progress::show(double share) {
  if (!is_terminal_ || ++calls_ % calls_between_looks_ != 0) return;
  const TimeNs now_ns = clock_.now_ns();
  if (now_ns < next_ns_) return;
  next_ns_ = now_ns + kEvery_ns;
  shown_ = true;
  std::fputs(fmt::format("\r{} {:3.0f} %", what_, 100 * share).c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace condyle::host
