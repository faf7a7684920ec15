// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/clock_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle::hal {
namespace {

constexpr TimeNs kLongestGap_ns = TimeNs{366} * 86'400 * kNanosecondsPerSecond;

// a - b, or the nearest value.
TimeNs difference(TimeNs a, TimeNs b) {
  TimeNs result = 0;
  if (!__builtin_sub_overflow(a, b, &result)) return result;
  return a < b ? std::numeric_limits<TimeNs>::min() : std::numeric_limits<TimeNs>::max();
}

// a + b, or the nearest value.
TimeNs sum(TimeNs a, TimeNs b) {
  TimeNs result = 0;
  if (!__builtin_add_overflow(a, b, &result)) return result;
  return a < 0 ? std::numeric_limits<TimeNs>::min() : std::numeric_limits<TimeNs>::max();
}

// The nearest whole number; 2^63 and beyond do not fit.
TimeNs rounded(double value_ns) {
  return std::llround(std::clamp(value_ns, -9.2e18, 9.2e18));
}

double median(double* values, int count) {
  std::nth_element(values, values + count / 2, values + count);
  return values[count / 2];
}

}  // namespace

TimeNs ClockFit::add(TimeNs device_ns, TimeNs arrival_ns) {
  const TimeNs elapsed_ns = difference(device_ns, last_device_ns_);
  if (has_origin_ && elapsed_ns >= 0 && elapsed_ns <= kLongestGap_ns) {
    device_run_ns_ += static_cast<double>(elapsed_ns);
    host_run_ns_ += static_cast<double>(difference(arrival_ns, last_arrival_ns_));
  }
  last_arrival_ns_ = arrival_ns;
  if (!has_origin_) {
    begin(device_ns, arrival_ns, FitOutcome::started);
  } else if (elapsed_ns < 0) {
    begin(device_ns, arrival_ns, FitOutcome::went_back);
  } else if (elapsed_ns > kLongestGap_ns) {
    begin(device_ns, arrival_ns, FitOutcome::ran_ahead);
  } else {
    outcome_ = FitOutcome::followed;
  }

  auto device = static_cast<double>(difference(device_ns, device_origin_ns_));
  double r = static_cast<double>(difference(arrival_ns, host_origin_ns_)) - device;
  if (r < (count_ == 0 ? least_r_ns_ : line(device)) - tolerance(device)) {
    begin(device_ns, arrival_ns, FitOutcome::ran_ahead);
    device = r = 0;
  } else if (device - second_begin_ns_ >= kSecond_ns) {
    if (!complete_second(arrival_ns)) {
      const double host = device + least_r_ns_;  // the late reports show where the host is now
      begin(device_ns, sum(host_origin_ns_, rounded(host)), FitOutcome::fell_behind);
      r = static_cast<double>(difference(arrival_ns, host_origin_ns_));
      device = 0;
    }
    begin_second(device, r, arrival_ns);
  } else if (r < least_r_ns_) {
    least_r_ns_ = r;
    least_device_ns_ = device;
  }
  largest_r_ns_ = std::max(largest_r_ns_, r);

  const double wanted = count_ == 0 ? std::min(least_r_ns_, in_use_ns_) : line(device);
  const bool is_new = outcome_ != FitOutcome::followed;
  const double limit = is_new ? 0 : (kSlew + std::abs(drift_)) * static_cast<double>(elapsed_ns);
  in_use_ns_ += std::clamp(wanted - in_use_ns_, -limit, limit);
  pending_ns_ = wanted - in_use_ns_;
  last_device_ns_ = device_ns;

  TimeNs time_ns = sum(host_origin_ns_, rounded(device + in_use_ns_));
  if (has_time_) time_ns = std::max(time_ns, last_time_ns_);
  last_time_ns_ = time_ns;
  has_time_ = true;
  return time_ns;
}

TimeNs ClockFit::offset_ns() const {
  return difference(last_time_ns_, last_device_ns_);
}

double ClockFit::uncertainty_s() const {
  const double pending = std::abs(pending_ns_);
  if (count_ == 0) {
    const double unseen = std::max(largest_r_ns_ - least_r_ns_, kUnseen_ns);
    return (unseen + pending) * 1e-9;
  }
  const auto [mean, square] = seconds_spread();
  // As for a straight line by least squares, of which medians are nearly as good. The added 1: the
  // earliest arrivals are themselves later than the least delay, by about their spread.
  const auto device = static_cast<double>(difference(last_device_ns_, device_origin_ns_));
  const double away = device - mean;
  const double leverage = 1.0 / count_ + (square > 0 ? away * away / square : 0);
  const double spread = arrival_spread_ns();
  double suspected = late_count_ > 0 ? most_late_ns_ : 0;
  for (const double away_ns :
       {newest_away_ns_, std::min(least_r_ns_ - line(least_device_ns_), 0.0)}) {
    if (std::abs(away_ns) > kSuspected * spread) suspected = std::max(suspected, std::abs(away_ns));
  }
  return (spread * std::sqrt(1 + leverage) + pending + suspected) * 1e-9;
}

double ClockFit::pace() const {
  constexpr double kLeast_ns = 2e9;
  return host_run_ns_ >= kLeast_ns ? device_run_ns_ / host_run_ns_ : 0;
}

double ClockFit::drift_uncertainty_ppm() const {
  if (count_ < 3) return std::numeric_limits<double>::infinity();
  const double count = count_;
  // Two degrees of freedom belong to the line.
  const double spread_ns = arrival_spread_ns() * std::sqrt(count / (count - 2));
  const double of_spread = spread_ns / std::sqrt(seconds_spread().square);
  const auto [first, last] = std::minmax_element(least_d_.begin(), least_d_.begin() + count_);
  const double of_frames = kFrame_ns / (std::sqrt(3.0) * (*last - *first));
  return 1e6 * std::hypot(of_spread, of_frames);
}

ClockFit::Spread ClockFit::seconds_spread() const {
  Spread spread;
  const auto count = static_cast<std::size_t>(count_);
  for (std::size_t i = 0; i < count; ++i) spread.mean += least_d_[i] / count_;
  for (std::size_t i = 0; i < count; ++i) {
    spread.square += (least_d_[i] - spread.mean) * (least_d_[i] - spread.mean);
  }
  return spread;
}

double ClockFit::arrival_spread_ns() const {
  const double unseen = kUnseen_ns / (static_cast<double>(count_) * count_);
  return std::sqrt(residual_ns_ * residual_ns_ + unseen * unseen);
}

// Restarts the fit, with the device's clock at `device_ns` when the host's was at `host_ns`.
void ClockFit::begin(TimeNs device_ns, TimeNs host_ns, FitOutcome outcome) {
  ClockFit fresh;
  fresh.has_time_ = has_time_;
  fresh.device_run_ns_ = device_run_ns_;
  fresh.host_run_ns_ = host_run_ns_;
  fresh.last_arrival_ns_ = last_arrival_ns_;
  fresh.last_time_ns_ = last_time_ns_;
  fresh.steps_ = steps_ + (outcome == FitOutcome::started ? 0 : 1);
  fresh.has_origin_ = true;
  fresh.outcome_ = outcome;
  fresh.device_origin_ns_ = fresh.last_device_ns_ = device_ns;
  fresh.host_origin_ns_ = fresh.second_arrival_ns_ = host_ns;
  *this = fresh;
}

void ClockFit::begin_second(double device, double r, TimeNs arrival_ns) {
  second_begin_ns_ = least_device_ns_ = device;
  least_r_ns_ = largest_r_ns_ = r;
  second_arrival_ns_ = arrival_ns;
}

// How early a report may be. If nothing was fitted for a while, the drift may have changed.
double ClockFit::tolerance(double device) const {
  return kStep_ns + kWander * (device - newest_d_ns_);
}

// Takes the collected second into the fit. False if it shows that the device fell behind.
bool ClockFit::complete_second(TimeNs arrival_ns) {
  if (is_late(arrival_ns)) return late_count_ < kLateSeconds;
  const auto next = static_cast<std::size_t>(next_);
  least_r_[next] = newest_r_ns_ = least_r_ns_;
  least_d_[next] = newest_d_ns_ = least_device_ns_;
  next_ = (next_ + 1) % kWindow;
  count_ = std::min(count_ + 1, kWindow);
  fit();
  return true;
}

// Whether all reports of the collected second came far too late to be fitted. Seconds count as
// consecutive if their reports came at their own pace, not all at once, and late by the same.
bool ClockFit::is_late(TimeNs arrival_ns) {
  const double late_ns = least_r_ns_ - line(least_device_ns_);
  if (count_ == 0 || late_ns <= tolerance(least_device_ns_)) {
    late_count_ = 0;
    return false;
  }
  const auto took_ns = static_cast<double>(difference(arrival_ns, second_arrival_ns_));
  const double least_ns = late_count_ > 0 ? std::min(least_late_ns_, late_ns) : late_ns;
  const double most_ns = late_count_ > 0 ? std::max(most_late_ns_, late_ns) : late_ns;
  const bool is_same = most_ns - least_ns < 0.5 * kStep_ns;
  const bool goes_on = late_count_ > 0 && is_same && took_ns > 0.5 * kSecond_ns;
  late_count_ = goes_on ? late_count_ + 1 : 1;
  least_late_ns_ = goes_on ? least_ns : late_ns;
  most_late_ns_ = goes_on ? most_ns : late_ns;
  return true;
}

void ClockFit::fit() {
  std::array<double, kWindow*(kWindow - 1) / 2> slopes;
  int slope_count = 0;
  const auto count = static_cast<std::size_t>(count_);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double run = least_d_[i] - least_d_[j];
      // Neighbours lie too close together to give a slope.
      if (std::abs(run) < 2 * kSecond_ns) continue;
      slopes[static_cast<std::size_t>(slope_count++)] = (least_r_[i] - least_r_[j]) / run;
    }
  }
  drift_ = slope_count > 0 ? median(slopes.data(), slope_count) : 0;
  std::array<double, kWindow> rest;
  for (std::size_t i = 0; i < count; ++i) rest[i] = least_r_[i] - drift_ * least_d_[i];
  offset_ns_ = median(rest.data(), count_);
  newest_away_ns_ = newest_r_ns_ - line(newest_d_ns_);
  for (double& value : rest) value = std::abs(value - offset_ns_);
  residual_ns_ = 1.4826 * median(rest.data(), count_);  // median to standard deviation
}

}  // namespace condyle::hal
