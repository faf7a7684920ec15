// SPDX-License-Identifier: Apache-2.0
#include "readings/uncertainty.h"

#include <cmath>

namespace condyle::host {
namespace {

// Beyond this share of draws without a value, the value depends on chance.
constexpr double kMostMissing = 0.1;
// Smoothing a second time changes noise by less than this, in standard deviations.
constexpr double kNoiseOfSmoothing = 0.7;
// What is left after the correction is far less than what was corrected; the interval contains this
// many times that.
constexpr double kTimesSmoothing = 2;

std::vector<Vector6> part(const std::vector<Vector6>& samples, std::size_t begin, std::size_t end) {
  return {samples.begin() + static_cast<std::ptrdiff_t>(begin),
          samples.begin() + static_cast<std::ptrdiff_t>(end)};
}

// Draws of a measure: their squares, their mean, and how many had no value.
struct Draws {
  double count = 0, squares = 0, excess = 0, missing = 0;
};

}  // namespace

SharedErrors shared_errors(const Landmarks* landmarks, const ReadingGeometry& geometry,
                           const Matrix6& reference) {
  SharedErrors errors{geometry, {}};
  if (landmarks != nullptr) {
    for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
      if (!(landmarks->sd_m[i] > 0)) continue;
      for (int axis = 0; axis < 3; ++axis) {
        Landmarks moved = *landmarks;
        moved.point_m[i][axis] += landmarks->sd_m[i];
        errors.off_by_one_sd.push_back(geometry_of(moved, geometry.middle_m));
      }
    }
  }
  const Matrix6 root = reference.llt().matrixL();
  for (int i = 0; i < 6 && root.allFinite(); ++i) {
    if (root.col(i).isZero(0)) continue;
    ReadingGeometry moved = geometry;
    moved.reference_shift_m = root.col(i).head<3>();
    moved.reference_turn_rad = root.col(i).tail<3>();
    errors.off_by_one_sd.push_back(moved);
  }
  return errors;
}

SmoothMotion smooth_motion(const ReferredMotion& motion, std::size_t begin, std::size_t end) {
  const LocalFit fit(motion.time_s, begin, end);
  SmoothMotion smooth{
      {motion.time_s.begin() + static_cast<std::ptrdiff_t>(begin),
       motion.time_s.begin() + static_cast<std::ptrdiff_t>(end)},
      {},
      {}};
  fit.apply(part(motion.motion, fit.first_used(), fit.end_used()), smooth.value, smooth.slope);
  return smooth;
}

std::vector<UncertainValue> uncertain_values(const ReferredMotion& motion, std::size_t begin,
                                             std::size_t end, const PoseNoise& noise,
                                             const SharedErrors& errors, int pairs,
                                             RandomGenerator& random, const ReadPath& read) {
  const LocalFit fit(motion.time_s, begin, end);
  const std::size_t first = fit.first_used(), last = fit.end_used();
  // The smoothed motion, with the margins that smoothing it again needs.
  const SmoothMotion wide = smooth_motion(motion, first, last);
  SmoothMotion smooth{{motion.time_s.begin() + static_cast<std::ptrdiff_t>(begin),
                       motion.time_s.begin() + static_cast<std::ptrdiff_t>(end)},
                      part(wide.value, begin - first, end - first),
                      part(wide.slope, begin - first, end - first)};
  JawPath path;
  std::vector<double> values, once, plus, minus;
  std::vector<std::string> why;
  paths_of(smooth, errors.geometry, path);
  read(path, values, &why);
  std::vector<UncertainValue> results(values.size());
  for (const ReadingGeometry& moved : errors.off_by_one_sd) {
    paths_of(smooth, moved, path);
    read(path, once, nullptr);
    for (std::size_t i = 0; i < results.size(); ++i) results[i].fixed.push_back(once[i] - values[i]);
  }
  const auto read_again = [&](const std::vector<Vector6>& samples, std::vector<double>& into) {
    fit.apply(samples, smooth.value, smooth.slope);
    paths_of(smooth, errors.geometry, path);
    read(path, into, nullptr);
  };
  read_again(wide.value, once);
  std::vector<Draws> draws(values.size());
  std::vector<Vector6> up(wide.value.size()), down(wide.value.size());
  for (int pair = 0; pair < pairs; ++pair) {
    for (std::size_t k = 0; k < wide.value.size(); ++k) {
      Vector6 normal;
      for (double& number : normal) number = random.normal();
      const Vector6 error = noise.root * normal;
      up[k] = wide.value[k] + error;
      down[k] = wide.value[k] - error;
    }
    read_again(up, plus);
    read_again(down, minus);
    for (std::size_t i = 0; i < draws.size(); ++i) {
      const double half = (plus[i] - minus[i]) / 2, middle = (plus[i] + minus[i]) / 2 - once[i];
      if (!std::isfinite(half) || !std::isfinite(middle)) {
        ++draws[i].missing;
        continue;
      }
      ++draws[i].count;
      draws[i].squares += half * half;
      draws[i].excess += middle;
    }
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    UncertainValue& result = results[i];
    result.missing = why[i];
    if (!std::isfinite(values[i])) continue;
    const Draws& drawn = draws[i];
    if (!std::isfinite(once[i]) || (pairs > 0 && drawn.missing > kMostMissing * pairs)) {
      result.missing = "whether the movement reaches it depends on noise";
      continue;
    }
    const double count = std::max(drawn.count, 1.0);
    const double variance = drawn.squares / count;
    const double smoothing = once[i] - values[i];
    result.noise_sd = std::sqrt(variance);
    // Beyond what noise alone changes.
    const double excess = std::max(std::abs(smoothing) - kNoiseOfSmoothing * result.noise_sd, 0.0);
    result.value = values[i] - std::copysign(excess, smoothing) - drawn.excess / count;
    result.smoothing = kTimesSmoothing * excess;
    for (const double change : result.fixed) {
      if (!std::isfinite(change)) result.missing = "whether the movement reaches it depends on the landmarks";
    }
    if (!result.missing.empty()) result.value = JawReading::kNone;
  }
  return results;
}

}  // namespace condyle::host
