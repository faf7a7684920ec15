// SPDX-License-Identifier: Apache-2.0
#include "simulation/reference_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "condyle/estimator/math/elementary.h"

namespace condyle::host {
namespace {

// A factor around 1 with the given spread, kept within three standard deviations and positive.
double vary(double spread, double normal) {
  return std::max(0.1, 1 + spread * std::clamp(normal, -3.0, 3.0));
}

}  // namespace

ReferenceMotion::ReferenceMotion(const MotionTask& task, Draws draws)
    : task_(task), draws_(std::move(draws)) {
  for (double& phase : phases_) phase = 2 * std::numbers::pi * draws_.uniform();
  next_cycle(0);
}

void ReferenceMotion::next_cycle(double start_s) {
  const double period_s = 1 / (task_.cycle_rate_Hz * vary(task_.rate_spread, draws_.normal()));
  cycle_.start_s = start_s;
  cycle_.depth_m = side_ * task_.amplitude_m * vary(task_.amplitude_spread, draws_.normal());
  cycle_.way_s = period_s * (1 - task_.dwell_share) / 2;
  cycle_.rest_s = period_s * task_.dwell_share;
  if (draws_.uniform() < task_.pause_probability) cycle_.rest_s += task_.pause_s;
  if (task_.alternates) side_ = -side_;
}

MotionPoint ReferenceMotion::at(double time_s) {
  while (time_s >= cycle_.start_s + 2 * cycle_.way_s + cycle_.rest_s) {
    next_cycle(cycle_.start_s + 2 * cycle_.way_s + cycle_.rest_s);
  }
  MotionPoint point{.position_m = task_.rest_position_m};
  const double since_s = time_s - cycle_.start_s;
  if (since_s < 2 * cycle_.way_s && cycle_.depth_m != 0) {
    const bool back = since_s >= cycle_.way_s;
    const double s = (back ? since_s - cycle_.way_s : since_s) / cycle_.way_s;
    const double s2 = s * s;
    const double sign = back ? 1 : -1;
    const double start = back ? -cycle_.depth_m : 0;
    const double shape = s * s2 * (10 - 15 * s + 6 * s2);
    point.position_m += start + sign * cycle_.depth_m * shape;
    point.velocity_m_s = sign * cycle_.depth_m / cycle_.way_s * 30 * s2 * (1 - s) * (1 - s);
    point.acceleration_m_s2 =
        sign * cycle_.depth_m / (cycle_.way_s * cycle_.way_s) * 60 * s * (1 - s) * (1 - 2 * s);
  }
  for (int i = 0; i < 3 && task_.tremor_m > 0; ++i) {
    const double rate = 2 * std::numbers::pi * task_.tremor_Hz * (0.85 + 0.15 * i);
    const double angle = rate * time_s + phases_[i];
    point.position_m += task_.tremor_m * elementary::sin(angle);
    point.velocity_m_s += task_.tremor_m * rate * elementary::cos(angle);
    point.acceleration_m_s2 -= task_.tremor_m * rate * rate * elementary::sin(angle);
  }
  return point;
}

}  // namespace condyle::host
