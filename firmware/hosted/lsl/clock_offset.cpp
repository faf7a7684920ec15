// SPDX-License-Identifier: Apache-2.0
#include "hosted/lsl/clock_offset.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace condyle::host::lsl {
namespace {

constexpr std::string_view kMethod = "LSL:timedata";

// Takes a number and the blanks before it off `text`.
template <class Number>
bool take_number(std::string_view& text, Number& value) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return false;
  text.remove_prefix(first);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool take_finite(std::string_view& text, double& value) {
  return take_number(text, value) && std::isfinite(value);
}

}  // namespace

std::string probe_text(std::uint32_t wave, double now_s) {
  return fmt::format("{}\r\n{} {:.16g}\r\n", kMethod, wave, now_s);
}

bool parse_probe_answer(std::string_view text, std::uint32_t wave, double now_s,
                        ProbeTimes& times) {
  std::uint32_t answered = 0;
  ProbeTimes read{.t0 = 0, .t1 = 0, .t2 = 0, .t3 = now_s};
  if (!take_number(text, answered) || answered != wave) return false;
  if (!take_finite(text, read.t0) || !take_finite(text, read.t1) || !take_finite(text, read.t2)) {
    return false;
  }
  times = read;
  return true;
}

std::string probe_answer(std::string_view text, double received_s, double now_s) {
  if (!text.starts_with(kMethod)) return "";
  text.remove_prefix(kMethod.size());
  std::uint32_t wave = 0;
  double t0 = 0;
  if (!take_number(text, wave) || !take_finite(text, t0)) return "";
  return fmt::format(" {} {:.16g} {:.16g} {:.16g}", wave, t0, received_s, now_s);
}

void ClockOffset::add(const ProbeTimes& times) {
  const double rtt_s = (times.t3 - times.t0) - (times.t2 - times.t1);
  // A clock that is read in steps may give a round trip of slightly less than 0.
  if (!(rtt_s > -1e-3 && times.t3 >= times.t0)) return;
  if (answers_ == 0 || rtt_s < best_rtt_s_) {
    best_rtt_s_ = rtt_s;
    best_offset_s_ = -((times.t1 - times.t0) + (times.t2 - times.t3)) / 2;
  }
  ++answers_;
}

bool ClockOffset::end_wave() {
  if (answers_ < kFewestAnswers) return false;
  wanted_s_ = best_offset_s_;
  uncertainty_s_ = std::max(best_rtt_s_, 0.0) / 2;
  if (!is_known_) {
    in_use_s_ = wanted_s_;
  } else if (std::abs(wanted_s_ - in_use_s_) > kStep_s) {
    in_use_s_ = wanted_s_;
    ++steps_;
  }
  is_known_ = true;
  return true;
}

double ClockOffset::at(double stamp_s) {
  if (has_stamp_) {
    const double limit_s = kSlew * std::clamp(stamp_s - last_stamp_s_, 0.0, 1.0);
    in_use_s_ += std::clamp(wanted_s_ - in_use_s_, -limit_s, limit_s);
  }
  has_stamp_ = true;
  last_stamp_s_ = stamp_s;
  return in_use_s_;
}

}  // namespace condyle::host::lsl
