// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording_description.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hosted/files/number_text.h"
#include "recordings/named_points.h"

namespace condyle::host {
namespace {

using Eigen::Index;

// The rate with the fewest digits whose step is `step_ns`, which is known to half a nanosecond.
double rate_of(TimeNs step_ns) {
  constexpr double kKnown_ns = 0.5 + 1e-6;
  const auto step = static_cast<double>(step_ns);
  const double rate_Hz = 1e9 / step;
  for (int digits = 1; digits <= 15; ++digits) {
    double rounded_Hz = rate_Hz;
    static_cast<void>(parse_number(fmt::format("{:.{}g}", rate_Hz, digits), rounded_Hz));
    if (std::abs(1e9 / rounded_Hz - step) <= kKnown_ns) return rounded_Hz;
  }
  return rate_Hz;
}

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
    } else if (sample.time_ns <= last_ns_) {
      ++found.time_reversed;
    } else {
      take_step(sample.time_ns - last_ns_, found);
    }
    has_time_ = true;
    last_ns_ = sample.time_ns;
    found.first_s = std::min(found.first_s, time_s);
    found.last_s = std::max(found.last_s, time_s);
  }

  void finish(RecordingDescription& found) {
    if (!median_ns_) find_median(found);
    if (median_ns_) found.rate_Hz = rate_of(*median_ns_);
  }

 private:
  static constexpr std::size_t kSteps = 1000;

  bool is_gap(TimeNs step_ns) const { return step_ns > *median_ns_ + *median_ns_ / 2; }

  void take_step(TimeNs step_ns, RecordingDescription& found) {
    if (median_ns_) {
      found.time_gaps += is_gap(step_ns) ? 1U : 0U;
      return;
    }
    steps_ns_.push_back(step_ns);
    if (steps_ns_.size() == kSteps) find_median(found);
  }

  void find_median(RecordingDescription& found) {
    if (steps_ns_.empty()) return;
    std::vector<TimeNs> sorted_ns = steps_ns_;
    const auto middle = sorted_ns.begin() + static_cast<std::ptrdiff_t>(sorted_ns.size() / 2);
    std::nth_element(sorted_ns.begin(), middle, sorted_ns.end());
    median_ns_ = *middle;
    for (const TimeNs step_ns : steps_ns_) found.time_gaps += is_gap(step_ns) ? 1U : 0U;
  }

  bool has_time_ = false;
  TimeNs last_ns_ = 0;
  std::vector<TimeNs> steps_ns_;  // the first
  std::optional<TimeNs> median_ns_;
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
