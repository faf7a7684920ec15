// SPDX-License-Identifier: Apache-2.0
#include "readings/uncertainty.h"

#include <algorithm>
#include <cmath>

namespace condyle::host {
namespace {

// Beyond this share of draws without a value, the value depends on chance.
constexpr double kMostMissing = 0.1;
// What is left after the correction is far less than what was corrected; the interval contains this
// many times that, and all that was subtracted for noise.
constexpr double kTimesSmoothing = 2;

std::vector<double> part_of(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  return {values.begin() + static_cast<std::ptrdiff_t>(begin),
          values.begin() + static_cast<std::ptrdiff_t>(end)};
}

std::vector<Vector6> part(const std::vector<Vector6>& samples, std::size_t begin, std::size_t end) {
  return {samples.begin() + static_cast<std::ptrdiff_t>(begin),
          samples.begin() + static_cast<std::ptrdiff_t>(end)};
}

// Draws of a measure: sums, and how many had no value.
struct Draws {
  double count = 0, sum = 0, squares = 0, missing = 0;
  void add(double difference) {
    ++count;
    sum += difference;
    squares += difference * difference;
  }
};

// Slopes of `values`: those of the quartics through five neighbours (Lagrange).
std::vector<Vector6> slopes_of(const std::vector<double>& time_s,
                               const std::vector<Vector6>& values) {
  const std::size_t count = values.size(), points = std::min<std::size_t>(5, count);
  std::vector<Vector6> slopes(count, Vector6::Zero());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first =
        std::clamp<std::size_t>(k, points / 2, count - points + points / 2) - points / 2;
    for (std::size_t j = first; j < first + points; ++j) {
      // Derivative at k of the polynomial that is 1 at j and 0 at the others.
      double weight = 0;
      if (j == k) {
        for (std::size_t m = first; m < first + points; ++m) {
          if (m != k) weight += 1 / (time_s[k] - time_s[m]);
        }
      } else {
        weight = 1 / (time_s[j] - time_s[k]);
        for (std::size_t m = first; m < first + points; ++m) {
          if (m != j && m != k) weight *= (time_s[k] - time_s[m]) / (time_s[j] - time_s[m]);
        }
      }
      slopes[k] += weight * values[j];
    }
  }
  return slopes;
}

// Means of `values` over `reach_s` on both sides, with triangular weights.
std::vector<Vector6> means_of(const std::vector<double>& time_s, const std::vector<Vector6>& values,
                              double reach_s) {
  std::vector<Vector6> means;
  for (std::size_t k = 0; k < values.size(); ++k) {
    Vector6 sum = values[k];
    double weights = 1;
    for (std::size_t i = 1; i <= k && k + i < values.size(); ++i) {
      const double weight = 1 - (time_s[k + i] - time_s[k - i]) / 2 / reach_s;
      if (weight <= 0) break;
      sum += weight * (values[k - i] + values[k + i]);
      weights += 2 * weight;
    }
    means.push_back(sum / weights);
  }
  return means;
}

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
  SmoothMotion smooth{{motion.time_s.begin() + static_cast<std::ptrdiff_t>(begin),
                       motion.time_s.begin() + static_cast<std::ptrdiff_t>(end)},
                      {},
                      {}};
  fit.apply(part(motion.motion, fit.first_used(), fit.end_used()), smooth.value, smooth.slope);
  return smooth;
}

std::vector<UncertainValue> uncertain_values(const ReferredMotion& motion, std::size_t begin,
                                             std::size_t end, const PoseNoise& noise,
                                             const SharedErrors& errors, DrawSettings settings,
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
    for (std::size_t i = 0; i < results.size(); ++i)
      results[i].fixed.push_back(once[i] - values[i]);
  }
  const auto read_again = [&](const std::vector<Vector6>& samples, std::vector<double>& into) {
    fit.apply(samples, smooth.value, smooth.slope);
    paths_of(smooth, errors.geometry, path);
    read(path, into, nullptr);
  };
  // What noise and smoothing add is seen on a path that has hardly any noise: a greatest value
  // among noisy ones would hide half of it.
  const LocalFit calm_fit(motion.time_s, first, last, settings.calm_half_s);
  std::vector<Vector6> calm, slopes;
  calm_fit.apply(part(motion.motion, calm_fit.first_used(), calm_fit.end_used()), calm, slopes);
  slopes = slopes_of(part_of(motion.time_s, first, last), calm);
  smooth.value = part(calm, begin - first, end - first);
  smooth.slope = part(slopes, begin - first, end - first);
  paths_of(smooth, errors.geometry, path);
  std::vector<double> calm_values;
  read(path, calm_values, nullptr);
  read_again(calm, once);
  // Draws start from a path whose tops are as flat as the true ones, with less noise still.
  const LocalFit mild_fit(motion.time_s, first, last, settings.mild_half_s);
  std::vector<Vector6> mild;
  mild_fit.apply(part(motion.motion, mild_fit.first_used(), mild_fit.end_used()), mild, slopes);
  mild = means_of(part_of(motion.time_s, first, last), mild, settings.mild_half_s / 2);
  std::vector<double> mild_values;
  read_again(mild, mild_values);
  std::vector<Draws> draws(values.size());
  std::vector<Vector6> up(calm.size()), down(calm.size());
  for (int pair = 0; pair < settings.pairs; ++pair) {
    for (std::size_t k = 0; k < calm.size(); ++k) {
      Vector6 normal;
      for (double& number : normal) number = random.normal();
      const Vector6 error = noise.root * normal;
      up[k] = mild[k] + error;
      down[k] = mild[k] - error;
    }
    read_again(up, plus);
    read_again(down, minus);
    for (std::size_t i = 0; i < draws.size(); ++i) {
      for (const double drawn : {plus[i], minus[i]}) {
        if (std::isfinite(drawn) && std::isfinite(mild_values[i])) {
          draws[i].add(drawn - mild_values[i]);
        } else {
          ++draws[i].missing;
        }
      }
    }
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    UncertainValue& result = results[i];
    result.missing = why[i];
    if (!std::isfinite(values[i])) continue;
    const Draws& drawn = draws[i];
    if (!std::isfinite(once[i]) || !std::isfinite(calm_values[i]) ||
        drawn.missing > kMostMissing * 2 * settings.pairs) {
      result.missing = "whether the movement reaches it depends on noise";
      continue;
    }
    const double count = std::max(drawn.count, 1.0), mean = drawn.sum / count;
    const double smoothing = once[i] - calm_values[i];
    result.value = values[i] - smoothing - mean;
    result.noise_sd = std::sqrt(std::max(drawn.squares / count - mean * mean, 0.0));
    result.smoothing = std::hypot(kTimesSmoothing * smoothing, mean);
    for (const double change : result.fixed) {
      if (!std::isfinite(change))
        result.missing = "whether the movement reaches it depends on the landmarks";
    }
    if (!result.missing.empty()) result.value = JawReading::kNone;
  }
  return results;
}

}  // namespace condyle::host
