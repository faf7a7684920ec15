// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording_description.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hosted/files/number_text.h"
#include "recordings/named_points.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

using Eigen::Index;

// The rate with the fewest digits whose step is `step_ns`, known to `known_ns`.
double rate_of(double step_ns, double known_ns) {
  const double rate_Hz = 1e9 / step_ns;
  for (int digits = 1; digits <= 15; ++digits) {
    double rounded_Hz = rate_Hz;
    static_cast<void>(parse_number(fmt::format("{:.{}g}", rate_Hz, digits), rounded_Hz));
    if (std::abs(1e9 / rounded_Hz - step_ns) <= known_ns) return rounded_Hz;
  }
  return rate_Hz;
}

// The times of a recording. Its rate is that of the mean step: times rounded to milliseconds have
// no other step than 4 or 5 ms at 240 Hz, and times rounded further repeat.
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
    } else if (sample.time_ns <= last_.time_ns) {
      ++found.time_reversed;
      if (sample.time_ns == last_.time_ns && !repeats_position(sample)) take_step(0, found);
    } else {
      take_step(sample.time_ns - last_.time_ns, found);
    }
    has_time_ = true;
    last_ = sample;
    found.first_s = std::min(found.first_s, time_s);
    found.last_s = std::max(found.last_s, time_s);
  }

  void finish(RecordingDescription& found) {
    if (!median_ns_) find_median(found);
    if (!median_ns_) return;
    // Half a nanosecond is lost when a time is read; rounding adds once to every run without gaps.
    const double count = static_cast<double>(usual_);
    const double spread_ns = static_cast<double>(longest_ns_ - shortest_ns_);
    const double runs = 1 + static_cast<double>(found.time_gaps);
    found.rate_Hz = rate_of(static_cast<double>(usual_sum_ns_) / count,
                            0.5 + 1e-6 + spread_ns * std::sqrt(runs) / count);
  }

 private:
  static constexpr std::size_t kSteps = 1000;

  bool repeats_position(const Sample& sample) const {
    return sample.position_valid == last_.position_valid &&
           std::equal(std::begin(sample.coordinates), std::end(sample.coordinates),
                      std::begin(last_.coordinates));
  }

  void take_step(TimeNs step_ns, RecordingDescription& found) {
    if (median_ns_) return judge(step_ns, found);
    steps_ns_.push_back(step_ns);
    if (steps_ns_.size() == kSteps) find_median(found);
  }

  void judge(TimeNs step_ns, RecordingDescription& found) {
    if (step_ns > *median_ns_ + *median_ns_ / 2) {
      ++found.time_gaps;
      return;
    }
    ++usual_;
    usual_sum_ns_ += step_ns;
    shortest_ns_ = std::min(shortest_ns_, step_ns);
    longest_ns_ = std::max(longest_ns_, step_ns);
  }

  void find_median(RecordingDescription& found) {
    std::vector<TimeNs> rising_ns;
    std::copy_if(steps_ns_.begin(), steps_ns_.end(), std::back_inserter(rising_ns),
                 [](TimeNs step_ns) { return step_ns > 0; });
    if (rising_ns.empty()) return;
    median_ns_ = shortest_ns_ = longest_ns_ = upper_median(std::move(rising_ns));
    for (const TimeNs step_ns : steps_ns_) judge(step_ns, found);
  }

  bool has_time_ = false;
  Sample last_;
  std::vector<TimeNs> steps_ns_;  // the first
  std::optional<TimeNs> median_ns_;
  // Steps that are no gaps.
  std::int64_t usual_ = 0;
  TimeNs usual_sum_ns_ = 0, shortest_ns_ = 0, longest_ns_ = 0;
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
