// SPDX-License-Identifier: Apache-2.0
#include "readings/peak_speed.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "readings/polynomial_fit.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr double kMargin_s = 0.4;                // of the paths, on both sides
constexpr int kNarrowest = 2, kLeastWidest = 4;  // samples on both sides
constexpr double kGrowth = 1.22;
// In standard deviations: of the difference between windows that agree.
constexpr double kAgreement = 1.8;
// In the same: of the difference at a narrower window's own peak, anywhere in the run.
constexpr double kBurst = 5.2;
constexpr double kNarrower = 1.6;
// How often the estimated error of the value is in the interval; and of the two differences that
// are there if no narrower window could confirm the value.
constexpr double kTimesError = 2, kHidden = 1.5, kUnconfirmed = 1.5, kTooFast = 3,
                 kFar = 1;                // kHidden: sd
constexpr double kMostDifference = 0.25;  // of the speed
// A gap of more steps and more of the wide window may hide a greater speed.
constexpr double kStepsOfGap = 2.5, kGapShare = 0.5;
// Beside an abrupt change of the speed the slope of a cubic overshoots by so much of the change at
// most: by 0.087 with three samples on both sides, by 0.061 with many.
constexpr double kOvershoot = 0.09;
constexpr double kNowhere = -1e300;  // the speed where there are too few samples
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

// Where a window's speed is greatest; without a speed if it finds samples nowhere.
struct SpeedReader::Peak {
  int width = 0;
  std::size_t at = 0;
  double speed_m_s = kNowhere;
};

SpeedReader::SpeedReader(const ReferredMotion& motion, SampleRun run, const PoseNoise& noise,
                         const SharedErrors& errors, PathPart part, double widest_s)
    : motion_(motion), noise_(noise), errors_(errors), part_(part), widest_s_(widest_s) {
  const auto& time_s = motion.time_s;
  first_ = run.begin;
  last_ = run.end;
  while (first_ > 0 && time_s[run.begin] - time_s[first_ - 1] <= kMargin_s) --first_;
  while (last_ < time_s.size() && time_s[last_] - time_s[run.end - 1] <= kMargin_s) ++last_;
  std::vector<double> steps_s;
  for (std::size_t k = first_ + 1; k < last_; ++k) steps_s.push_back(time_s[k] - time_s[k - 1]);
  if (steps_s.empty()) return;
  step_s_ = upper_median(std::move(steps_s));
  const SmoothMotion raw{
      {time_s.begin() + static_cast<std::ptrdiff_t>(first_),
       time_s.begin() + static_cast<std::ptrdiff_t>(last_)},
      {motion.motion.begin() + static_cast<std::ptrdiff_t>(first_),
       motion.motion.begin() + static_cast<std::ptrdiff_t>(last_)},
      std::vector<Vector6>(last_ - first_, Vector6::Zero()),
  };
  TurningMotion turning;
  turning_of(raw, turning);
  paths_of(raw, turning, errors.geometry, part, path_);
}

Places SpeedReader::places_of(const ReadingGeometry& geometry, SpeedPoint point, std::size_t begin,
                              std::size_t end) const {
  const auto from = static_cast<std::ptrdiff_t>(first_ + begin);
  const auto to = static_cast<std::ptrdiff_t>(first_ + end);
  const SmoothMotion raw{
      {motion_.time_s.begin() + from, motion_.time_s.begin() + to},
      {motion_.motion.begin() + from, motion_.motion.begin() + to},
      std::vector<Vector6>(end - begin, Vector6::Zero()),
  };
  TurningMotion turning;
  turning_of(raw, turning);
  JawPath path;
  paths_of(raw, turning, geometry, part_, path);
  return point == SpeedPoint::incisor ? path.incisor_m
                                      : path.condyle_m[point == SpeedPoint::condyle_left ? 0 : 1];
}

// What noise with the `root` of its covariance does to the point at sample `k`.
Eigen::Matrix3d SpeedReader::noise_of(SpeedPoint point, std::size_t k, const Matrix6& root) const {
  SmoothMotion moved;
  for (int i = -1; i < 6; ++i) {
    moved.time_s.push_back(0);
    moved.value.push_back(motion_.motion[first_ + k]);
    if (i >= 0) moved.value.back() += root.col(i);
    moved.slope.emplace_back(Vector6::Zero());
  }
  JawPath path;
  paths_of(moved, errors_.geometry, path);
  const Places& places = point == SpeedPoint::incisor
                             ? path.incisor_m
                             : path.condyle_m[point == SpeedPoint::condyle_left ? 0 : 1];
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Vector3d change = places[i] - places[0];
    covariance += change * change.transpose();
  }
  return covariance;
}

// Of the point at sample `k`, where it moves with `velocity`.
PointNoise SpeedReader::noise_of(SpeedPoint point, std::size_t k, const Vector3d& velocity) const {
  const Vector3d displaced = noise_.stamp_sd_s * velocity;
  PointNoise noise{noise_of(point, k, noise_.white_root()) + displaced * displaced.transpose(), {}};
  for (const SharedNoise& part : noise_.shared) {
    noise.shared.push_back(noise_of(point, k, part.root));
  }
  return noise;
}

// The samples of the cubic around sample `k`; none if there are too few.
SampleRun SpeedReader::window_at(std::size_t k, double half_s) const {
  const auto& time_s = path_.time_s;
  SampleRun window{k, k + 1};
  while (window.begin > 0 && time_s[k] - time_s[window.begin - 1] <= half_s) --window.begin;
  while (window.end < time_s.size() && time_s[window.end] - time_s[k] <= half_s) ++window.end;
  const bool is_enough = k >= window.begin + kNarrowest && window.end >= k + 1 + kNarrowest;
  return is_enough ? window : SampleRun{k, k};
}

Slope SpeedReader::slope_at(std::size_t k, int width) const {
  const auto& time_s = path_.time_s;
  const double half_s = (width + 0.25) * step_s_;
  const SampleRun window = window_at(k, half_s);
  Slope slope;
  slope.first = window.begin;
  if (window.begin == window.end) return slope;
  PowerSums powers;
  for (std::size_t i = window.begin; i < window.end; ++i) {
    powers.add((time_s[i] - time_s[k]) / half_s);
  }
  const Eigen::RowVector4d row = powers.rows()[1];
  for (std::size_t i = window.begin; i < window.end; ++i) {
    const double x = (time_s[i] - time_s[k]) / half_s;
    slope.weights.push_back((row[0] + x * (row[1] + x * (row[2] + x * row[3]))) / half_s);
  }
  return slope;
}

// kNowhere if there are too few samples. The speed and those up and down share the velocities.
double SpeedReader::speed_at(const Places& places, std::size_t k, int width, int way) {
  auto& known = velocities_[{&places, width}];
  if (known.empty()) known.resize(places.size(), Vector3d::Constant(kUnknown));
  Vector3d& velocity = known[k];
  if (std::isnan(velocity.x())) velocity = velocity_at(places, k, width);
  if (velocity.x() == kNowhere) return kNowhere;
  return way == 0 ? velocity.norm() : way * velocity.z();
}

// The slope as in slope_at, from the samples' moments.
Vector3d SpeedReader::velocity_at(const Places& places, std::size_t k, int width) const {
  const auto& time_s = path_.time_s;
  const double half_s = (width + 0.25) * step_s_;
  const SampleRun window = window_at(k, half_s);
  if (window.begin == window.end) return Vector3d::Constant(kNowhere);
  PowerSums powers;
  std::array<Vector3d, 4> moments;
  moments.fill(Vector3d::Zero());
  for (std::size_t i = window.begin; i < window.end; ++i) {
    const double x = (time_s[i] - time_s[k]) / half_s, square = x * x;
    powers.add(x);
    const Vector3d from_here = places[i] - places[k];
    moments[0] += from_here;
    moments[1] += x * from_here;
    moments[2] += square * from_here;
    moments[3] += square * x * from_here;
  }
  const Eigen::RowVector4d row = powers.rows()[1];
  Vector3d velocity = Vector3d::Zero();
  for (int i = 0; i < 4; ++i) velocity += row[i] / half_s * moments[static_cast<std::size_t>(i)];
  return velocity;
}

// The peak of each window, from the narrowest to the widest.
std::vector<SpeedReader::Peak> SpeedReader::peaks_of(const Places& places, SampleRun run, int way) {
  std::vector<Peak> peaks;
  const auto longest = static_cast<double>(run.end - run.begin);
  for (double width = kNarrowest;
       width <= std::max<double>(kLeastWidest, widest_s_ / step_s_) && width <= longest;
       width = std::max(std::round(width) + 1, width * kGrowth)) {
    Peak peak;
    peak.width = static_cast<int>(std::lround(width));
    const auto take = [&](std::size_t k) {
      const double speed_m_s = speed_at(places, k, peak.width, way);
      if (speed_m_s > peak.speed_m_s) {
        peak.speed_m_s = speed_m_s;
        peak.at = k;
      }
    };
    // A wide window's speed changes slowly: first here and there, then around the greatest.
    const auto stride = static_cast<std::size_t>(std::max(1, peak.width / 6));
    for (std::size_t k = run.begin; k < run.end; k += stride) take(k);
    const std::size_t near = peak.at, from = near - std::min(near - run.begin, stride - 1);
    if (!(peak.speed_m_s > 0)) continue;
    for (std::size_t k = from; k < std::min(near + stride, run.end); ++k) take(k);
    peaks.push_back(peak);
  }
  return peaks;
}

// What noise adds to a greatest value: it decides where the peak is found.
double SpeedReader::noise_of_place(const Places& places, const Slope& slope, std::size_t k,
                                   int width, int way, const NoiseAlong& noise) {
  const auto& time_s = path_.time_s;
  if (k == 0 || k + 1 >= time_s.size()) return 0;
  const auto reach = static_cast<std::size_t>(std::max(1, width / 2));
  const std::size_t low = k - std::min(k, reach), high = std::min(k + reach, time_s.size() - 1);
  const Slope before = slope_at(k - 1, width), after = slope_at(k + 1, width);
  const double here = speed_at(places, k, width, way), behind = speed_at(places, low, width, way);
  const double ahead = speed_at(places, high, width, way);
  if (before.weights.empty() || after.weights.empty() || slope.weights.empty() ||
      behind == kNowhere || ahead == kNowhere) {
    return 0;
  }
  const double curve =
      2 *
      ((ahead - here) / (time_s[high] - time_s[k]) - (here - behind) / (time_s[k] - time_s[low])) /
      (time_s[high] - time_s[low]);
  if (!(curve < 0)) return 0;
  const double apart_s = time_s[k + 1] - time_s[k - 1];
  return noise.variance_of(after.mixed(1 / apart_s, before, -1 / apart_s)) / (-2 * curve);
}

// How far the slope at sample `k` may overshoot if the speed changes abruptly less than `width`
// samples away.
double SpeedReader::overshoot_at(const Places& places, std::size_t k, int width, int way) {
  const auto reach = static_cast<std::size_t>(width);
  const double before = speed_at(places, k - std::min(k, reach), width, way);
  const double after = speed_at(places, std::min(k + reach, places.size() - 1), width, way);
  const bool is_known = before != kNowhere && after != kNowhere;
  return kOvershoot * std::abs(is_known ? after - before : speed_at(places, k, width, way));
}

// Whether the slope of a window of `width` differs from that at the peak of a narrower one. A
// change of direction counts, too.
bool SpeedReader::passes_over(const Places& places, const Peak& burst, int width, int way,
                              const PointNoise& noise) const {
  const Slope narrow = slope_at(burst.at, burst.width), wide = slope_at(burst.at, width);
  if (narrow.weights.empty() || wide.weights.empty()) return false;
  const Slope difference = narrow.mixed(1, wide, -1);
  const Vector3d passed = difference.of(places);
  const Vector3d direction = way == 0 ? Vector3d(passed.normalized()) : Vector3d(0, 0, way);
  const NoiseAlong along_it = along(direction, noise, noise_.shared, step_s_);
  return direction.dot(passed) > kBurst * std::sqrt(along_it.variance_of(difference));
}

UncertainValue SpeedReader::greatest(SpeedPoint point, SampleRun run, int way) {
  UncertainValue result;
  result.fixed.assign(errors_.off_by_one_sd.size(), 0);
  result.missing = "too few samples around the greatest speed";
  result.is_hidden = true;
  const Places& places = point == SpeedPoint::incisor
                             ? path_.incisor_m
                             : path_.condyle_m[point == SpeedPoint::condyle_left ? 0 : 1];
  if (!(step_s_ > 0) || run.end <= run.begin) return result;
  const std::vector<Peak> peaks = peaks_of(places, {run.begin - first_, run.end - first_}, way);
  if (peaks.size() < 3) return result;

  const auto direction_of = [&](const Slope& slope) -> Vector3d {
    return way == 0 ? Vector3d(slope.of(places).normalized()) : Vector3d(0, 0, way);
  };
  std::size_t wide = peaks.size() - 1;
  bool agrees = false;
  for (; wide > 0 && !agrees; --wide) {
    const std::size_t at = peaks[wide].at;
    const Slope slope = slope_at(at, peaks[wide].width);
    const Vector3d direction = direction_of(slope);
    const PointNoise of_point = noise_of(point, at, slope.of(places));
    const NoiseAlong noise = along(direction, of_point, noise_.shared, step_s_);
    agrees = true;
    for (std::size_t i = 0; i < wide && agrees; ++i) {
      const Slope narrower = slope_at(at, peaks[i].width);
      if (narrower.weights.empty()) continue;
      const Slope difference = slope.mixed(1, narrower, -1);
      agrees = std::abs(direction.dot(difference.of(places))) <=
               kAgreement * std::sqrt(noise.variance_of(difference));
    }
    for (std::size_t i = 0; i < wide && agrees; ++i) {
      agrees = !passes_over(places, peaks[i], peaks[wide].width, way, of_point);
    }
    if (agrees) break;
  }
  if (!agrees) wide = 1;
  std::size_t narrow = wide - 1;
  while (narrow > 0 && peaks[narrow].width * kNarrower > peaks[wide].width) --narrow;

  const std::size_t at = peaks[agrees ? wide : narrow].at;
  const Slope slope = slope_at(at, peaks[narrow].width), wider = slope_at(at, peaks[wide].width);
  if (slope.weights.empty() || wider.weights.empty() ||
      !(direction_of(slope).dot(slope.of(places)) > 0)) {
    return result;
  }
  const Vector3d velocity = slope.of(places), direction = direction_of(slope);
  const PointNoise point_noise = noise_of(point, at, velocity);
  const NoiseAlong noise = along(direction, point_noise, noise_.shared, step_s_);
  const double ratio = std::pow(static_cast<double>(peaks[narrow].width) / peaks[wide].width, 4);
  const double share = ratio / (1 - ratio);
  const Slope difference = wider.mixed(1, slope, -1);
  const double differs_m_s = direction.dot(difference.of(places));
  const double speed_m_s = direction.dot(velocity);
  // What noise hides may be there in all strokes, whose mean has less noise.
  const double hidden_m_s =
      std::max(std::abs(differs_m_s), kHidden * std::sqrt(noise.variance_of(difference)));
  double smoothing_m_s = !agrees       ? kTooFast * std::abs(differs_m_s)
                         : narrow == 0 ? kUnconfirmed * std::abs(differs_m_s)
                                       : kTimesError * share * hidden_m_s;
  if (narrow == 0) {
    const Slope far = slope_at(at, peaks[2].width).mixed(1, slope, -1);
    if (!agrees) {
      smoothing_m_s = std::max(smoothing_m_s, kFar * std::abs(direction.dot(far.of(places))));
    }
  }
  if (!agrees && std::abs(differs_m_s) > kMostDifference * speed_m_s) {
    result.missing = "the movement is too fast for the rate of the recording";
    return result;
  }
  const double gap_s = longest_gap_s(motion_.time_s, run.begin, run.end);
  if (gap_s > std::max(kStepsOfGap, kGapShare * peaks[wide].width) * step_s_) {
    result.missing = fmt::format("a gap of {:.2f} s may hide a greater speed", gap_s);
    return result;
  }
  // The top between the samples: found where the wider window is trusted, read in the other.
  const int finder = peaks[agrees ? wide : narrow].width;
  const auto& time_s = path_.time_s;
  double top_m_s = 0;
  if (at > 0 && at + 1 < time_s.size()) {
    const double a = time_s[at - 1] - time_s[at], b = time_s[at + 1] - time_s[at];
    const auto parabola = [&](int width) {
      const double here = speed_at(places, at, width, way);
      const double before = speed_at(places, at - 1, width, way);
      const double after = speed_at(places, at + 1, width, way);
      if (before == kNowhere || after == kNowhere) return std::pair(0.0, 0.0);
      const double p = before - here, q = after - here;
      const double curve = (p * b - q * a) / (a * b * (a - b));
      return std::pair((p - curve * a * a) / a, curve);
    };
    const auto [finder_slope, finder_curve] = parabola(finder);
    if (finder_curve < 0) {
      const double x = std::clamp(-finder_slope / (2 * finder_curve), a / 2, b / 2);
      const auto [read_slope, read_curve] = parabola(peaks[narrow].width);
      top_m_s = (read_slope + read_curve * x) * x;
    }
  }
  const Slope corrected = slope.mixed(1, difference, -share);
  const double sd_m_s = std::sqrt(noise.variance_of(corrected));
  const double across_m_s =
      way == 0 ? across(direction, point_noise, noise_.shared, step_s_).variance_of(slope) /
                     (2 * speed_m_s)
               : 0;
  const double of_place =
      std::min(noise_of_place(places, agrees ? wider : slope, at, finder, way, noise), sd_m_s);
  result.missing.clear();
  result.is_hidden = false;
  result.value = 1e3 * (speed_m_s + top_m_s - share * differs_m_s - across_m_s - of_place);
  result.noise_sd = 1e3 * sd_m_s;
  const double overshoot_m_s = overshoot_at(places, at, peaks[wide].width, way);
  result.doubt = 1e3 * std::hypot(smoothing_m_s, across_m_s + of_place, overshoot_m_s);
  for (std::size_t i = 0; i < result.fixed.size(); ++i) {
    const Places moved =
        places_of(errors_.off_by_one_sd[i], point, slope.first, slope.first + slope.weights.size());
    Slope here = slope;
    here.first = 0;
    const Vector3d changed = here.of(moved);
    result.fixed[i] = 1e3 * ((way == 0 ? changed.norm() : way * changed.z()) - speed_m_s);
  }
  return result;
}

}  // namespace condyle::host
