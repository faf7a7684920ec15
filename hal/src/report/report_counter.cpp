// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/report_counter.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle::hal {
namespace {

// A count further ahead than this is not a loss of reports, however wide the counter.
constexpr std::uint64_t kMostLost = std::uint64_t{1} << 31U;
constexpr double kLongestStep_ns = 366 * 86400e9;
constexpr double kFurthestTime_ns = 9.2e18;  // TimeNs ends at 9.22e18

// Values of a counter; 0: 2^64.
std::uint64_t modulus_of(const CountingField& counting) {
  if (counting.wraps_at != 0) return counting.wraps_at;
  return counting.field.width_bits >= 64 ? 0 : std::uint64_t{1} << counting.field.width_bits;
}

// How far `to` is ahead of `from`. Unsigned arithmetic is modulo 2^64 already.
std::uint64_t distance(std::uint64_t from, std::uint64_t to, std::uint64_t modulus) {
  return to >= from ? to - from : to - from + modulus;
}

std::uint64_t elapsed_ns(TimeNs from, TimeNs to) {
  return to > from ? static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from) : 0;
}

// Scales are decimal, so 1e-6 s is not exactly 1000 ns.
double nanoseconds_a_tick(double scale_s) {
  const double exact = scale_s * 1e9;
  const double whole = std::round(exact);
  return std::abs(exact - whole) < 1e-12 * exact ? whole : exact;
}

}  // namespace

SequenceCounter::SequenceCounter(const CountingField& field, double rate_Hz,
                                 bool restarts_on_reconnect)
    : modulus_(modulus_of(field)),
      rate_Hz_(rate_Hz),
      restarts_on_reconnect_(restarts_on_reconnect) {}

SequenceStep SequenceCounter::advance(std::uint64_t count, TimeNs host_time_ns) {
  SequenceStep step;
  if (has_last_) {
    const std::uint64_t ahead = distance(last_, count, modulus_);
    const std::uint64_t furthest = modulus_ == 0 ? kMostLost : std::min(modulus_ / 2, kMostLost);
    const double expected =
        static_cast<double>(elapsed_ns(last_host_ns_, host_time_ns)) * 1e-9 * rate_Hz_;
    if (is_new_ || expected >= static_cast<double>(furthest)) {
      step.outcome = SequenceOutcome::unknown_loss;
      sequence_ += 1;
    } else if (ahead == 0) {
      step.outcome = SequenceOutcome::duplicated;
    } else if (ahead > furthest) {
      step.outcome = SequenceOutcome::restarted;
      sequence_ += 1;
    } else {
      step.outcome = ahead == 1 ? SequenceOutcome::next : SequenceOutcome::lost;
      step.lost = ahead - 1;
      sequence_ += ahead;
    }
  }
  has_last_ = true;
  is_new_ = false;
  last_ = count;
  last_host_ns_ = host_time_ns;
  step.sequence = sequence_;
  return step;
}

DeviceClock::DeviceClock(const CountingField& field, double rate_Hz, bool restarts_on_reconnect)
    : modulus_(modulus_of(field)),
      tick_ns_(nanoseconds_a_tick(field.field.scale)),
      wrap_ns_((modulus_ == 0 ? 0x1p64 : static_cast<double>(modulus_)) * tick_ns_),
      period_ns_(rate_Hz > 0 ? 1e9 / rate_Hz : 0),
      restarts_on_reconnect_(restarts_on_reconnect) {}

ClockStep DeviceClock::advance(std::uint64_t ticks, TimeNs host_time_ns, std::uint64_t reports) {
  const bool is_first = !has_last_, is_restarted = is_new_;
  const std::uint64_t host_ns = is_first ? 0 : elapsed_ns(last_host_ns_, host_time_ns);
  const std::uint64_t ahead = distance(last_, ticks, modulus_);
  has_last_ = true;
  is_new_ = false;
  last_ = ticks;
  last_host_ns_ = host_time_ns;
  if (is_first) {
    anchor_ns_ = time_ns_ = host_time_ns;
    return {ClockOutcome::first, time_ns_};
  }
  if (is_restarted) return go_on_by_host(ClockOutcome::restarted, host_ns);
  const double step_ns = static_cast<double>(ahead) * tick_ns_;
  const double wraps = wraps_for(step_ns, static_cast<double>(host_ns), reports);
  if (wraps < 0) return go_on_by_host(ClockOutcome::jumped_back, host_ns);
  if (!(step_ns + wraps * wrap_ns_ <= kLongestStep_ns)) {
    return go_on_by_host(ClockOutcome::jumped_ahead, host_ns);
  }
  // Below kLongestStep_ns, so neither product exceeds 64 bits.
  const std::uint64_t step = ahead + static_cast<std::uint64_t>(wraps) * modulus_;
  if (!move_by(step)) return go_on_by_host(ClockOutcome::jumped_ahead, host_ns);
  return {ClockOutcome::next, time_ns_};
}

// Whole wraps in addition to a step of `step_ns`; -1: the clock went back instead.
double DeviceClock::wraps_for(double step_ns, double host_ns, std::uint64_t reports) const {
  const auto nearest = [&](double expected_ns) {
    return std::round((expected_ns - step_ns) / wrap_ns_);
  };
  const double by_reports_ns = static_cast<double>(reports) * period_ns_;
  if (by_reports_ns > 0) {
    // The host may be late by any time; the device keeps its rate unless it pauses.
    const double tolerance_ns = 0.5 * period_ns_ + 0.1 * by_reports_ns;
    const double wraps = nearest(by_reports_ns);
    const bool is_explained = std::abs(step_ns + wraps * wrap_ns_ - by_reports_ns) <= tolerance_ns;
    if (wraps >= 0 && is_explained) return wraps;
  }
  return nearest(host_ns);
}

bool DeviceClock::move_by(std::uint64_t ticks) {
  const std::uint64_t total = ticks_since_anchor_ + ticks;
  const double since_anchor_ns = static_cast<double>(total) * tick_ns_;
  if (static_cast<double>(anchor_ns_) + since_anchor_ns > kFurthestTime_ns) return false;
  const double whole = std::floor(tick_ns_);
  time_ns_ = anchor_ns_ + static_cast<TimeNs>(total) * static_cast<TimeNs>(whole) +
             static_cast<TimeNs>(std::llround(static_cast<double>(total) * (tick_ns_ - whole)));
  ticks_since_anchor_ = total;
  // After a century from the anchor the products would exceed 64 bits.
  if (since_anchor_ns > 100 * kLongestStep_ns) {
    anchor_ns_ = time_ns_;
    ticks_since_anchor_ = 0;
  }
  return true;
}

ClockStep DeviceClock::go_on_by_host(ClockOutcome outcome, std::uint64_t host_ns) {
  const std::uint64_t room = elapsed_ns(time_ns_, std::numeric_limits<TimeNs>::max());
  // Unsigned, because the host's step alone can exceed int64.
  if (host_ns <= room) {
    time_ns_ = static_cast<TimeNs>(static_cast<std::uint64_t>(time_ns_) + host_ns);
  }
  anchor_ns_ = time_ns_;
  ticks_since_anchor_ = 0;
  return {outcome, time_ns_};
}

}  // namespace condyle::hal
