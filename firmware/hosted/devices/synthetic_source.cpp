// SPDX-License-Identifier: Apache-2.0
#include "hosted/devices/synthetic_source.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hosted/devices/facebow_report.h"

namespace condyle::host {
namespace {

// Opens and closes once in 0.8 s, with some lateral motion and noise.
constexpr double kCycle_s = 0.8, kOpening_m = 12e-3, kSideways_m = 2e-3, kNoise_m = 30e-6;
// Two points behind the incisor, beside each other.
constexpr double kBehind_m = 40e-3, kBeside_m = 30e-3;

}  // namespace

// Noise: the sum of four uniform numbers from Lehmer's generator (Park and Miller 1988, doi
// 10.1145/63039.63042).
std::int16_t SyntheticSource::noisy_units(double position_m) {
  double sum = -2;
  for (int i = 0; i < 4; ++i) {
    random_ = static_cast<std::uint32_t>(random_ * std::uint64_t{48271} % 2147483647);
    sum += random_ / 2147483647.0;
  }
  position_m += kNoise_m * std::numbers::sqrt3 * sum;
  return static_cast<std::int16_t>(std::lround(position_m / fake::kCoordinateUnit_m));
}

hal::Status SyntheticSource::open() {
  if (counter_ == 0) begin_ns_ = clock_.now_ns();
  is_open_ = true;
  return hal::Status::ok;
}

TimeNs SyntheticSource::due_ns() const {
  return begin_ns_ + nanoseconds((static_cast<double>(counter_) + 1) / rate_Hz_);
}

hal::Status SyntheticSource::read(TimeNs deadline_ns, hal::RawReport& report) {
  if (!is_open_) return hal::Status::not_open;
  const TimeNs due = due_ns();
  const bool sleeps = clock_.now_ns() < std::min(due, deadline_ns);
  clock_.sleep_until(std::min(due, deadline_ns));
  if (deadline_ns < due) return hal::Status::timeout;
  const TimeNs now_ns = clock_.now_ns();
  if (sleeps) wake_up_.add(now_ns - due);

  const double phase = 2 * std::numbers::pi * seconds(due - begin_ns_) / kCycle_s;
  const double x = kSideways_m * std::sin(phase);
  const double z = -0.5 * kOpening_m * (1 - std::cos(phase));
  fake::ReportContent content;
  content.counter = static_cast<std::uint32_t>(counter_);
  content.time_us = static_cast<std::uint32_t>(static_cast<std::uint64_t>(due - begin_ns_) / 1000);
  const double positions_m[] = {x, 0, z, x + kBeside_m, kBehind_m, z, x - kBeside_m, kBehind_m, z};
  for (std::size_t i = 0; i < content.coordinates.size(); ++i) {
    content.coordinates[i] = noisy_units(positions_m[i]);
  }
  const fake::FacebowReport bytes = fake::encode(content);
  std::copy(bytes.begin(), bytes.end(), report.bytes.begin());
  report.size = static_cast<std::uint16_t>(bytes.size());
  report.host_time_ns = now_ns;
  ++counter_;
  return hal::Status::ok;
}

}  // namespace condyle::host
