// SPDX-License-Identifier: Apache-2.0
#include "output/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace condyle::host {
namespace {
constexpr TimeNs kFirst_ns = kNanosecondsPerSecond;
constexpr TimeNs kEvery_ns = kNanosecondsPerSecond / 5;
constexpr std::size_t kLooks = 150;  // half a minute
constexpr double kLeastElapsed_s = 3;
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

std::string time_left_text(double before, double now, double elapsed_s) {
  if (!(elapsed_s >= kLeastElapsed_s) || !(now > before) || !(now <= 1)) return "";
  const double left_s = elapsed_s * (1 - now) / (now - before);
  if (left_s < 90) return fmt::format(", about {:.0f} s left", left_s);
  if (left_s < 90 * 60) return fmt::format(", about {:.0f} min left", left_s / 60);
  return fmt::format(", about {:.1f} h left", left_s / 3600);
}

void Progress::show(double share) {
  if (!is_terminal_ || ++calls_ % calls_between_looks_ != 0) return;
  const TimeNs now_ns = clock_.now_ns();
  if (now_ns < next_ns_) return;
  next_ns_ = now_ns + kEvery_ns;
  shown_ = true;
  if (looks_.size() == kLooks) looks_.pop_front();
  looks_.push_back({now_ns, share});
  const Look& first = looks_.front();
  const double elapsed_s = 1e-9 * static_cast<double>(now_ns - first.time_ns);
  std::fputs(fmt::format("\r{} {:3.0f} %{}\x1b[K", what_, 100 * share,
                         time_left_text(first.share, share, elapsed_s))
                 .c_str(),
             stderr);
  std::fflush(stderr);
}

}  // namespace condyle::host
