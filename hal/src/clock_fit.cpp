// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/clock_fit.h"

namespace condyle::hal {

TimeNs ClockFit::add(TimeNs device_ns, TimeNs arrival_ns) {
  if (!has_origin_) {
    *this = [&] {
      ClockFit fresh;
      fresh.has_time_ = has_time_;
      fresh.last_time_ns_ = last_time_ns_;
      return fresh;
    }();
    has_origin_ = true;
    device_origin_ns_ = device_ns;
    host_origin_ns_ = arrival_ns;
  }
  const auto device = static_cast<double>(device_ns - device_origin_ns_);
  const double r = static_cast<double>(arrival_ns - host_origin_ns_) - device;
  if (device - second_begin_ns_ >= kSecond_ns) {
    complete_second();
    second_begin_ns_ = device;
    least_r_ns_ = r;
    least_device_ns_ = device;
  } else if (r - least_r_ns_ < 0) {
    least_r_ns_ = r;
    least_device_ns_ = device;
  }
  const double wanted = count_ == 0 ? least_r_ns_ : offset_ns_ + drift_ * device;
  const double elapsed = device - last_device_ns_;
  const double limit = (kSlew + std::abs(drift_)) * elapsed;
  in_use_ns_ += std::clamp(wanted - in_use_ns_, -limit, limit);
  pending_ns_ = wanted - in_use_ns_;
  last_device_ns_ = device;

  TimeNs time_ns = host_origin_ns_ + std::llround(device + in_use_ns_);
  if (has_time_) time_ns = std::max(time_ns, last_time_ns_);
  last_time_ns_ = time_ns;
  has_time_ = true;
  return time_ns;
}

void ClockFit::complete_second() {
  const auto next = static_cast<std::size_t>(next_);
  least_r_[next] = least_r_ns_;
  least_d_[next] = least_device_ns_;
  next_ = (next_ + 1) % kWindow;
  count_ = std::min(count_ + 1, kWindow);

  std::array<double, kWindow*(kWindow - 1) / 2> slopes;
  int slope_count = 0;
  const auto count = static_cast<std::size_t>(count_);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double run = least_d_[i] - least_d_[j];
      // Neighbours lie too near each other to tell a slope.
      if (std::abs(run) < 2 * kSecond_ns) continue;
      slopes[static_cast<std::size_t>(slope_count++)] = (least_r_[i] - least_r_[j]) / run;
    }
  }
  drift_ = slope_count > 0 ? median(slopes.data(), slope_count) : 0;
  std::array<double, kWindow> rest;
  for (std::size_t i = 0; i < count; ++i) rest[i] = least_r_[i] - drift_ * least_d_[i];
  offset_ns_ = median(rest.data(), count_);
  for (double& value : rest) value = std::abs(value - offset_ns_);
  residual_ns_ = 1.4826 * median(rest.data(), count_);  // median to standard deviation
}

}  // namespace condyle::hal
