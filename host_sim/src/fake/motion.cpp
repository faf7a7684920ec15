// SPDX-License-Identifier: Apache-2.0
#include "fake/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"

namespace condyle::host::fake {
namespace {

// Rest positions of points 1 to 3, for recordings of a single point: as the simulated facebow's.
constexpr double kPlaces_m[3][3] = {{0, 0, 0}, {0.025, 0, 0.03}, {-0.025, 0, 0.03}};

// The part of a recording that determines its rate.
constexpr int kRowsForRate = 256;

std::optional<double> mean_rate_Hz(Recording& recording) {
  Sample first, last;
  if (!recording.next(first)) return std::nullopt;
  int steps = 0;
  for (Sample sample; steps < kRowsForRate && recording.next(sample); ++steps) last = sample;
  if (steps == 0 || !first.time_valid || !last.time_valid || last.time_ns <= first.time_ns) {
    return std::nullopt;
  }
  return steps / seconds(last.time_ns - first.time_ns);
}

double coordinate_m(const Sample& sample, std::size_t point, std::size_t axis) {
  switch (sample.kind) {
    case SampleKind::three_points:
      return sample.coordinates[3 * point + axis];
    case SampleKind::one_axis:
      return kPlaces_m[point][axis] + (axis == 2 ? sample.coordinates[0] : 0);
    default:
      return kPlaces_m[point][axis] + sample.coordinates[axis];
  }
}

}  // namespace

Motion::Motion(Opener open, bool repeats) : open_(std::move(open)), repeats_(repeats) {
  reopen();
  rate_Hz_ = mean_rate_Hz(*recording_);
  reopen();
  if (recording_->info().kind == SampleKind::pose) {
    throw InputError(recording_->place(), "poses cannot be sent",
                     "give a recording of one or three points");
  }
}

void Motion::reopen() {
  recording_ = open_();
}

bool Motion::next(RawCoordinates& coordinates) {
  Sample sample;
  if (!recording_->next(sample)) {
    if (!repeats_) return false;
    reopen();
    if (!recording_->next(sample)) {
      throw InputError(recording_->place(), "has no samples", "give a recording with a motion");
    }
  }
  if (!sample.position_valid) {
    coordinates.fill(kNotSeen);
    return true;
  }
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const double value = std::round(coordinate_m(sample, i / 3, i % 3) / kCoordinateUnit_m);
    if (!(std::abs(value) <= 32767)) {
      throw InputError(recording_->place(),
                       fmt::format("{}{} = {:.6g} m does not fit the report", "xyz"[i % 3],
                                   i / 3 + 1, value * kCoordinateUnit_m),
                       "its range is -0.131 to 0.131 m; choose another origin");
    }
    coordinates[i] = static_cast<std::int16_t>(value);
  }
  return true;
}

}  // namespace condyle::host::fake
