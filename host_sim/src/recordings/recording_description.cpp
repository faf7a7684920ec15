// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording_description.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "recordings/named_points.h"

namespace condyle::host {
namespace {

using Eigen::Index;

// The times of a recording.
class Clock {
 public:
  void add(const Sample& sample, RecordingDescription& found) {
    if (!sample.time_valid) {
      ++found.time_missing;
      return;
    }
    const double time_s = seconds(sample.time_ns);
    if (!has_time_) {
      found.first_s = found.last_s = time_s;
    } else if (time_s <= last_s_) {
      ++found.time_reversed;
    } else {
      take_step(time_s - last_s_, found);
    }
    has_time_ = true;
    last_s_ = time_s;
    found.first_s = std::min(found.first_s, time_s);
    found.last_s = std::max(found.last_s, time_s);
  }

  void finish(RecordingDescription& found) {
    if (!median_s_) find_median(found);
    if (median_s_) found.rate_Hz = 1 / *median_s_;
  }

 private:
  static constexpr std::size_t kSteps = 1000;

  void take_step(double step_s, RecordingDescription& found) {
    if (median_s_) {
      found.time_gaps += step_s > 1.5 * *median_s_ ? 1U : 0U;
      return;
    }
    steps_s_.push_back(step_s);
    if (steps_s_.size() == kSteps) find_median(found);
  }

  void find_median(RecordingDescription& found) {
    if (steps_s_.empty()) return;
    std::vector<double> sorted_s = steps_s_;
    const auto middle = sorted_s.begin() + static_cast<std::ptrdiff_t>(sorted_s.size() / 2);
    std::nth_element(sorted_s.begin(), middle, sorted_s.end());
    median_s_ = *middle;
    for (const double step_s : steps_s_) found.time_gaps += step_s > 1.5 * *median_s_ ? 1U : 0U;
  }

  bool has_time_ = false;
  double last_s_ = 0;
  std::vector<double> steps_s_;  // the first
  std::optional<double> median_s_;
};

// The points of the sample last returned, NaN where missing.
Eigen::Matrix3Xd points_of_sample(const Sample& sample) {
  const Index points = sample.kind == SampleKind::three_points ? 3 : 1;
  Eigen::Matrix3Xd points_m = Eigen::Map<const Eigen::Matrix3Xd>(sample.coordinates, 3, points);
  if (!sample.position_valid) points_m.setConstant(std::numeric_limits<double>::quiet_NaN());
  return points_m;
}

void add(const Eigen::Vector3d& place_m, std::size_t axes, std::uint64_t& run,
         PointDescription& point) {
  if (!place_m.head(static_cast<Index>(axes)).allFinite()) {
    ++point.missing;
    point.gaps += run++ == 0 ? 1U : 0U;
    point.longest_gap = std::max(point.longest_gap, run);
    return;
  }
  run = 0;
  if (axes == 3 && place_m.isZero(0)) ++point.zeros;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const double value_m = place_m[static_cast<Index>(axis)];
    point.low_m[axis] = std::min(point.low_m[axis], value_m);
    point.high_m[axis] = std::max(point.high_m[axis], value_m);
  }
}

}  // namespace

RecordingDescription describe_recording(Recording& recording,
                                        const std::function<bool()>& is_stopped) {
  RecordingDescription found;
  auto* const named = dynamic_cast<NamedPointsRecording*>(&recording);
  std::vector<std::string> names;
  if (named != nullptr && !named->names().empty()) {
    names = named->names();
  } else {
    switch (recording.info().kind) {
      case SampleKind::one_axis:
        found.axes = 1;
        names = {"position"};
        break;
      case SampleKind::one_point:
        names = {"p1"};
        break;
      case SampleKind::three_points:
        names = {"p1", "p2", "p3"};
        break;
      case SampleKind::pose:
        names = {"pose"};
        break;
    }
    if (named != nullptr && found.axes == 3) names.clear();  // a file without points
  }
  constexpr double kNone = std::numeric_limits<double>::infinity();
  for (const std::string& name : names) {
    found.points.push_back(
        {.name = name, .low_m = {kNone, kNone, kNone}, .high_m = {-kNone, -kNone, -kNone}});
  }
  std::vector<std::uint64_t> runs(names.size());
  Clock clock;
  Sample sample;
  const bool has_names = named != nullptr && !named->names().empty();
  while (!is_stopped() && recording.next(sample)) {
    ++found.samples;
    clock.add(sample, found);
    found.drive += sample.drive_valid ? 1U : 0U;
    if (names.empty()) continue;
    const Eigen::Matrix3Xd points_m = has_names ? named->points_m() : points_of_sample(sample);
    for (std::size_t i = 0; i < names.size(); ++i) {
      add(points_m.col(static_cast<Index>(i)), found.axes, runs[i], found.points[i]);
    }
  }
  clock.finish(found);
  found.info = recording.info();
  if (found.info.stated.rate_Hz) found.rate_Hz = found.info.stated.rate_Hz;
  return found;
}

}  // namespace condyle::host
