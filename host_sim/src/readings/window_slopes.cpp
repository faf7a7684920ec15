// SPDX-License-Identifier: Apache-2.0
#include "readings/window_slopes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "readings/polynomial_fit.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr double kMargin_s = 0.4;  // of the paths, on both sides
// Beside an abrupt change of the speed the slope of a cubic overshoots by so much of the change at
// most: by 0.087 with three samples on both sides, by 0.061 with many.
constexpr double kOvershoot = 0.09;
// In standard deviations: a change between slopes that noise does not explain, and a smaller next
// one that it does not. The shortest step (samples on one side of its middle).
constexpr double kSurely = 3.7, kClearly = 2, kShortest = 1.5;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

const Places& of_point(const JawPath& path, SpeedPoint point) {
  switch (point) {
    case SpeedPoint::incisor:
      return path.incisor_m;
    case SpeedPoint::middle:
      return path.middle_m;
    default:
      return path.condyle_m[point == SpeedPoint::condyle_left ? 0 : 1];
  }
}

}  // namespace

WindowSlopes::WindowSlopes(const ReferredMotion& motion, SampleRun run, const PoseNoise& noise,
                           const SharedErrors& errors, PathPart part)
    : motion_(motion), noise_(noise), errors_(errors), part_(part) {
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

const Places& WindowSlopes::places_of(SpeedPoint point) const {
  return of_point(path_, point);
}

Places WindowSlopes::places_of(const ReadingGeometry& geometry, SpeedPoint point, std::size_t begin,
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
  return of_point(path, point);
}

// What noise with the `root` of its covariance does to the point at sample `k`.
Eigen::Matrix3d WindowSlopes::noise_of(SpeedPoint point, std::size_t k, const Matrix6& root) const {
  SmoothMotion moved;
  for (int i = -1; i < 6; ++i) {
    moved.time_s.push_back(0);
    moved.value.push_back(motion_.motion[first_ + k]);
    if (i >= 0) moved.value.back() += root.col(i);
    moved.slope.emplace_back(Vector6::Zero());
  }
  JawPath path;
  paths_of(moved, errors_.geometry, path);
  const Places& places = of_point(path, point);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Vector3d change = places[i] - places[0];
    covariance += change * change.transpose();
  }
  return covariance;
}

// Of the point at sample `k`, where it moves with `velocity`.
PointNoise WindowSlopes::noise_of(SpeedPoint point, std::size_t k, const Vector3d& velocity) const {
  const Vector3d displaced = noise_.stamp_sd_s * velocity;
  PointNoise noise{noise_of(point, k, noise_.white_root()) + displaced * displaced.transpose(), {}};
  for (const SharedNoise& part : noise_.shared) {
    noise.shared.push_back(noise_of(point, k, part.root));
  }
  return noise;
}

// The samples of the cubic around sample `k`; none if there are too few.
SampleRun WindowSlopes::window_at(std::size_t k, double half_s) const {
  const auto& time_s = path_.time_s;
  SampleRun window{k, k + 1};
  while (window.begin > 0 && time_s[k] - time_s[window.begin - 1] <= half_s) --window.begin;
  while (window.end < time_s.size() && time_s[window.end] - time_s[k] <= half_s) ++window.end;
  const bool is_enough = k >= window.begin + kNarrowest && window.end >= k + 1 + kNarrowest;
  return is_enough ? window : SampleRun{k, k};
}

Slope WindowSlopes::slope_at(std::size_t k, int width) const {
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

const Vector3d& WindowSlopes::velocity_at(const Places& places, std::size_t k, int width) {
  auto& known = velocities_[{&places, width}];
  if (known.empty()) known.resize(places.size(), Vector3d::Constant(kUnknown));
  Vector3d& velocity = known[k];
  if (std::isnan(velocity.x())) velocity = read_velocity(places, k, width);
  return velocity;
}

double WindowSlopes::speed_at(const Places& places, std::size_t k, int width, int way) {
  const Vector3d& velocity = velocity_at(places, k, width);
  if (velocity.x() == kNowhere) return kNowhere;
  return way == 0 ? velocity.norm() : way * velocity.z();
}

// The slope as in slope_at, from the samples' moments.
Vector3d WindowSlopes::read_velocity(const Places& places, std::size_t k, int width) const {
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

double WindowSlopes::overshoot_at(const Places& places, std::size_t k, int width, int way) {
  const auto reach = static_cast<std::size_t>(width);
  const double before = speed_at(places, k - std::min(k, reach), width, way);
  const double after = speed_at(places, std::min(k + reach, places.size() - 1), width, way);
  const bool is_known = before != kNowhere && after != kNowhere;
  return kOvershoot * std::abs(is_known ? after - before : speed_at(places, k, width, way));
}

bool WindowSlopes::passes_over(const Places& places, std::size_t k, int narrow_width, int width,
                               int way, const PointNoise& noise, double threshold) const {
  const Slope narrow = slope_at(k, narrow_width), wide = slope_at(k, width);
  if (narrow.weights.empty() || wide.weights.empty()) return false;
  const Slope difference = narrow.mixed(1, wide, -1);
  const Vector3d passed = difference.of(places);
  const Vector3d direction = way == 0 ? Vector3d(passed.normalized()) : Vector3d(0, 0, way);
  const NoiseAlong along_it = along(direction, noise, noise_.shared, step_s_);
  return direction.dot(passed) > threshold * std::sqrt(along_it.variance_of(difference));
}

double WindowSlopes::least_sd_of_difference(int narrow_width, int width,
                                            const PointNoise& noise) const {
  // Beside a gap the noise is larger, so that one place would not do.
  double least_gain = std::numeric_limits<double>::infinity();
  for (const std::size_t quarter : {1U, 2U, 3U}) {
    const std::size_t k = quarter * path_.time_s.size() / 4;
    const Slope narrow = slope_at(k, narrow_width), wide = slope_at(k, width);
    if (narrow.weights.empty() || wide.weights.empty()) return 0;
    least_gain = std::min(least_gain, narrow.mixed(1, wide, -1).gain());
  }
  const double least_variance =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(noise.white, Eigen::EigenvaluesOnly)
          .eigenvalues()[0];
  return std::sqrt(std::max(least_variance, 0.0) * least_gain);
}

bool WindowSlopes::may_pass_over(const Places& places, std::size_t k, int narrow_width, int width,
                                 double least_m_s) {
  const Vector3d &narrow = velocity_at(places, k, narrow_width),
                 &wide = velocity_at(places, k, width);
  return narrow.x() != kNowhere && wide.x() != kNowhere && (narrow - wide).norm() >= least_m_s;
}

double WindowSlopes::abrupt_change_at(const Places& places, std::size_t k, int width, int way,
                                      const PointNoise& noise) const {
  const auto times_wider = [width](double times) {
    return static_cast<int>(std::ceil(times * width));
  };
  const int widest = times_wider(kNarrower * kNarrower);
  const Slope here = slope_at(k, width);
  if (here.weights.empty() || widest * step_s_ > kMargin_s) return 0;
  const Slope wide = slope_at(k, times_wider(kNarrower));
  const Slope last = here.mixed(1, wide, -1), before = wide.mixed(1, slope_at(k, widest), -1);
  const Vector3d change = last.of(places);
  const Vector3d direction = way == 0 ? Vector3d(change.normalized()) : Vector3d(0, 0, way);
  const NoiseAlong along_it = along(direction, noise, noise_.shared, step_s_);
  const double change_m_s = direction.dot(change);
  if (!(change_m_s > kSurely * std::sqrt(along_it.variance_of(last)))) return 0;
  if (direction.dot(before.of(places)) > change_m_s) return 0;
  const Slope narrow = slope_at(k, static_cast<int>(std::lround(width / kNarrower)));
  if (!narrow.weights.empty()) {
    const Slope next = narrow.mixed(1, here, -1);
    const double most_m_s =
        direction.dot(next.of(places)) + kClearly * std::sqrt(along_it.variance_of(next));
    if (most_m_s < change_m_s) return 0;
  }
  return change_m_s * std::log(width / kShortest) / std::log(kNarrower);
}

}  // namespace condyle::host
