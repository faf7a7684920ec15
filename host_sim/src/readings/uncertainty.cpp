// SPDX-License-Identifier: Apache-2.0
#include "readings/uncertainty.h"

#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <cmath>

#include "condyle/estimator/pose/rotation_vector.h"
#include "readings/abrupt_parts.h"

namespace condyle::host {
namespace {

// Beyond this share of draws without a value, the value depends on chance.
constexpr double kMostMissing = 0.1;
constexpr double kAside_m = 1e-6;  // nearer to Y = 0, rounding must not decide on the side
// Half of the window that shows what the wide one hides, and its fewest samples, which at low rates
// make it longer.
constexpr double kNarrowHalf_s = 0.02;
constexpr std::size_t kLeastNarrow = 5;
constexpr double kTimesNoise = 6, kGreatestReach_s = 0.6;

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
    if (!std::isfinite(difference)) {
      ++missing;
      return;
    }
    ++count;
    sum += difference;
    squares += difference * difference;
  }
  double mean() const { return sum / std::max(count, 1.0); }
  double sd() const {
    return std::sqrt(std::max(squares / std::max(count, 1.0) - mean() * mean(), 0.0));
  }
};

// A smoothing, and what is read of the samples and of the calmer paths smoothed by it.
struct Window {
  explicit Window(LocalFit with) : fit(std::move(with)) {}
  LocalFit fit;
  std::vector<double> of_samples, of_calm, of_mild, drawn;
  SmoothMotion samples, calm, mild;
  std::vector<Vector6> error_value, error_slope;
};

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

// What smoothing changed, S C y - C y, is subtracted, with the noise that the calm window C leaves:
// standard deviation of S e - (S C e - C e) over that of S e, of white noise e. `first`: of the
// samples of `calm`; `begin` to `end`: those that are read.
double growth_of_noise(const LocalFit& fit, const LocalFit& calm, std::size_t first,
                       std::size_t begin, std::size_t end) {
  RandomGenerator random(1);
  const SampleRun used = calm.used();
  std::vector<Vector6> white(used.end - used.begin), smooth, calmed, both, slopes;
  boost::random::normal_distribution<double> normal;
  for (Vector6& numbers : white) {
    for (double& number : numbers) number = normal(random);
  }
  calm.apply(white, used.begin, calmed, slopes);
  fit.apply(white, used.begin, begin, end, smooth, slopes);
  fit.apply(calmed, first, begin, end, both, slopes);
  double corrected = 0, uncorrected = 0;
  for (std::size_t k = 0; k < smooth.size(); ++k) {
    corrected += (smooth[k] - both[k] + calmed[k + begin - first]).squaredNorm();
    uncorrected += smooth[k].squaredNorm();
  }
  return uncorrected > 0 ? std::sqrt(std::max(corrected / uncorrected, 1.0)) : 1;
}

// What a shared error changes of the incisor's path: turn of the head's axes and shift of the
// incisor, in these axes.
Vector6 change_of(const ReadingGeometry& geometry, const ReadingGeometry& moved) {
  const auto into_head = geometry.head.linear().transpose();
  Vector6 change;
  change << rotation_vector_of<double>(into_head * moved.head.linear()),
      into_head * (moved.incisor_m - geometry.incisor_m);
  return change;
}

bool is_of_reference(const ReadingGeometry& moved) {
  return !moved.reference_shift_m.isZero(0) || !moved.reference_turn_rad.isZero(0);
}

// The geometries to read, and what each shared error is of them: changes * shares are the changes
// by the errors. Of the incisor's path six geometries tell, to first order, what the 18 coordinates
// of the landmarks change: these turn the head's axes and shift the incisor.
struct GeometriesToRead {
  std::vector<ReadingGeometry> geometries;
  Eigen::MatrixXd shares;
};
GeometriesToRead geometries_to_read(const SharedErrors& errors, PathPart part) {
  const auto count = static_cast<Eigen::Index>(errors.off_by_one_sd.size());
  GeometriesToRead result{{}, Eigen::MatrixXd::Zero(6 + count, count)};
  const auto add = [&result](const ReadingGeometry& moved) {
    result.geometries.push_back(moved);
    return result.shares.row(static_cast<Eigen::Index>(result.geometries.size()) - 1);
  };
  Eigen::Matrix<double, 6, Eigen::Dynamic> changes(6, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const ReadingGeometry& moved = errors.off_by_one_sd[static_cast<std::size_t>(i)];
    const bool is_read = part == PathPart::all || is_of_reference(moved);
    if (is_read) add(moved)[i] = 1;
    changes.col(i) = is_read ? Vector6::Zero() : change_of(errors.geometry, moved);
  }
  // A mirrored recording has mirrored errors: turns about X and Z and shifts along Y change sign.
  const bool is_mirrored =
      (errors.geometry.head.inverse(Eigen::Isometry) * errors.geometry.incisor_m).y() < -kAside_m;
  for (int j = 0; j < 6; ++j) {
    const bool is_odd = j == 0 || j == 2 || j == 4;
    const double size = (is_odd && is_mirrored ? -1 : 1) * changes.row(j).lpNorm<Eigen::Infinity>();
    if (size == 0) continue;
    ReadingGeometry moved = errors.geometry;
    auto axes = moved.head.linear();
    if (j < 3) {
      axes = axes * rotation_of<double>(size * Eigen::Vector3d::Unit(j));
    } else {
      moved.incisor_m += size * axes.col(j - 3);
    }
    add(moved) = changes.row(j) / size;
  }
  result.shares.conservativeResize(static_cast<Eigen::Index>(result.geometries.size()), count);
  return result;
}

}  // namespace

ReferredMotion near_greatest_of(const JawPath& path, const ReferredMotion& motion,
                                const PoseNoise& noise, SampleRun run) {
  const auto squares = noise.covariance.diagonal();
  const double turn_noise_rad = std::sqrt(squares.tail<3>().sum());
  const double lever_m = (path.incisor_at_m - path.middle_at_m).norm();
  const double noise_m = std::sqrt(squares.head<3>().sum()) + lever_m * turn_noise_rad;
  double far_m = 0, turn_rad = 0;
  for (std::size_t k = run.begin; k < run.end; ++k) {
    far_m = std::max(far_m, path.incisor_m[k].norm());
    turn_rad = std::max(turn_rad, path.rotation_rad[k].norm());
  }
  std::vector<bool> is_used(run.end - run.begin, false);
  std::size_t used_to = run.begin;
  for (std::size_t k = run.begin; k < run.end; ++k) {
    if (path.incisor_m[k].norm() < far_m - kTimesNoise * noise_m &&
        path.rotation_rad[k].norm() < turn_rad - kTimesNoise * turn_noise_rad) {
      continue;
    }
    std::size_t first = std::max(k, used_to);
    while (first > used_to && path.time_s[k] - path.time_s[first - 1] < kGreatestReach_s) --first;
    for (; first < run.end && path.time_s[first] - path.time_s[k] < kGreatestReach_s; ++first) {
      is_used[first - run.begin] = true;
    }
    used_to = first;
  }
  ReferredMotion result{motion.middle_m, {}, {}};
  for (std::size_t k = run.begin; k < run.end; ++k) {
    if (!is_used[k - run.begin]) continue;
    result.time_s.push_back(motion.time_s[k]);
    result.motion.push_back(motion.motion[k]);
  }
  return result;
}

SharedErrors shared_errors(const Landmarks* landmarks, const ReadingGeometry& geometry,
                           const Matrix6& reference) {
  SharedErrors errors{geometry, {}};
  if (landmarks != nullptr) {
    for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
      if (!(landmarks->sd_m[i] > 0)) continue;
      for (int axis = 0; axis < 3; ++axis) {
        Landmarks moved = *landmarks;
        double& coordinate_m = moved.point_m[i][axis];
        // Sideways away from Y = 0, so that a mirrored recording has mirrored errors.
        coordinate_m += (axis == 1 && coordinate_m < -kAside_m ? -1 : 1) * landmarks->sd_m[i];
        errors.off_by_one_sd.push_back(geometry_of(moved, geometry.middle_m));
      }
    }
  }
  Matrix6 root = reference.llt().matrixL();
  if (geometry.incisor_m.y() < -kAside_m) mirror_columns(root);
  for (int i = 0; i < 6 && root.allFinite(); ++i) {
    if (root.col(i).isZero(0)) continue;
    ReadingGeometry moved = geometry;
    moved.reference_shift_m = root.col(i).head<3>();
    moved.reference_turn_rad = root.col(i).tail<3>();
    errors.off_by_one_sd.push_back(moved);
  }
  return errors;
}

std::vector<UncertainValue> uncertain_values(const ReferredMotion& motion, std::size_t begin,
                                             std::size_t end, const PoseNoise& noise,
                                             const SharedErrors& errors, DrawSettings settings,
                                             RandomGenerator& random, const ReadPath& read) {
  // Samples that the fits use are smoothed too, to be smoothed again.
  const auto [first, last] = samples_of_fit(motion.time_s, begin, end);
  const std::vector<double> times_s = part_of(motion.time_s, begin, end);
  Window wide(LocalFit(motion.time_s, begin, end)),
      narrow(LocalFit(motion.time_s, begin, end, kNarrowHalf_s, kLeastNarrow));
  SmoothMotion smooth{times_s, {}, {}};
  JawPath path;
  TurningMotion turning;
  const auto read_turned = [&](const ReadingGeometry& geometry, std::vector<double>& into,
                               std::vector<std::string>* why) {
    paths_of(smooth, turning, geometry, settings.part, path);
    read(path, into, why);
  };
  const auto read_smooth = [&](std::vector<double>& into, std::vector<std::string>* why = nullptr) {
    turning_of(smooth, turning);
    read_turned(errors.geometry, into, why);
  };
  std::vector<std::string> why;
  for (Window* const window : {&narrow, &wide}) {
    window->fit.apply(motion.motion, 0, begin, end, smooth.value, smooth.slope);
    window->samples = smooth;
    read_smooth(window->of_samples, &why);
  }
  const std::vector<double>& values = wide.of_samples;
  std::vector<UncertainValue> results(values.size());
  const auto [geometries, shares] = geometries_to_read(errors, settings.part);
  Eigen::MatrixXd changes(values.size(), geometries.size());
  std::vector<double> moved;
  for (std::size_t k = 0; k < geometries.size(); ++k) {
    read_turned(geometries[k], moved, nullptr);
    for (std::size_t i = 0; i < values.size(); ++i) {
      changes(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = moved[i] - values[i];
    }
  }
  changes *= shares;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto row = changes.row(static_cast<Eigen::Index>(i));
    results[i].fixed.assign(row.begin(), row.end());
  }
  // What noise and smoothing add is seen on a path that has hardly any noise: a greatest value
  // among noisy ones would hide half of it.
  const LocalFit calm_fit(motion.time_s, first, last, settings.calm_half_s);
  std::vector<Vector6> calm, slopes;
  calm_fit.apply(motion.motion, 0, calm, slopes);
  slopes = slopes_of(part_of(motion.time_s, first, last), calm);
  smooth.value = part(calm, begin - first, end - first);
  smooth.slope = part(slopes, begin - first, end - first);
  std::vector<double> calm_values;
  read_smooth(calm_values);
  // Draws start from a path whose tops are as flat as the true ones, with less noise still.
  const LocalFit mild_fit(motion.time_s, first, last, settings.mild_half_s);
  std::vector<Vector6> mild;
  mild_fit.apply(motion.motion, 0, mild, slopes);
  mild = means_of(part_of(motion.time_s, first, last), mild, settings.mild_half_s / 2);
  for (Window* const window : {&narrow, &wide}) {
    window->fit.apply(calm, first, begin, end, smooth.value, smooth.slope);
    window->calm = smooth;
    read_smooth(window->of_calm);
    window->fit.apply(mild, first, begin, end, smooth.value, smooth.slope);
    read_smooth(window->of_mild);
    window->mild = smooth;
  }
  std::vector<Draws> draws(values.size()), narrowings(values.size());
  // Smoothing is linear: the smoothed noise is added to the smoothed path, and subtracted.
  std::vector<Vector6> error(mild.size());
  const std::vector<double> error_time_s = part_of(motion.time_s, first, last);
  AbruptParts abrupt;
  boost::random::normal_distribution<double> normal;
  for (int pair = 0; pair < settings.pairs; ++pair) {
    for (std::size_t k = 0; k < error.size(); ++k) {
      Vector6 numbers;
      for (double& number : numbers) number = normal(random);
      error[k] = noise.white_root() * numbers;
      if (noise.stamp_sd_s > 0) error[k] += noise.stamp_sd_s * normal(random) * slopes[k];
    }
    add_shared_noise(noise.shared, error_time_s, random, error);
    // Half of the pairs suffice for the noise of narrowing.
    const bool is_narrowed = pair % 2 == 0;
    const auto draw = [&](Window& window, double sign) {
      for (std::size_t k = 0; k < times_s.size(); ++k) {
        smooth.value[k] = window.mild.value[k] + sign * window.error_value[k];
        smooth.slope[k] = window.mild.slope[k] + sign * window.error_slope[k];
      }
      read_smooth(window.drawn);
    };
    wide.fit.apply(error, first, begin, end, wide.error_value, wide.error_slope);
    if (is_narrowed) {
      narrow.fit.apply(error, first, begin, end, narrow.error_value, narrow.error_slope);
      abrupt.add_noise(narrow.error_value, wide.error_value);
    }
    for (const double sign : {1.0, -1.0}) {
      draw(wide, sign);
      for (std::size_t i = 0; i < draws.size(); ++i) {
        draws[i].add(wide.drawn[i] - wide.of_mild[i]);
      }
      if (!is_narrowed) continue;
      draw(narrow, sign);
      for (std::size_t i = 0; i < draws.size(); ++i) {
        narrowings[i].add((narrow.drawn[i] - narrow.of_mild[i]) -
                          (wide.drawn[i] - wide.of_mild[i]));
      }
    }
  }
  const std::vector<bool> is_abrupt = abrupt.of(narrow.samples, wide.samples);
  std::vector<double> of_abrupt, of_calm_abrupt;
  if (!is_abrupt.empty()) {
    smooth = narrowed_where(is_abrupt, narrow.samples, wide.samples);
    read_smooth(of_abrupt);
    smooth = narrowed_where(is_abrupt, narrow.calm, wide.calm);
    read_smooth(of_calm_abrupt);
  }
  const double growth = growth_of_noise(wide.fit, calm_fit, first, begin, end);
  for (std::size_t i = 0; i < results.size(); ++i) {
    UncertainValue& result = results[i];
    result.missing = why[i];
    if (!std::isfinite(values[i])) continue;
    if (!std::isfinite(wide.of_calm[i]) || !std::isfinite(calm_values[i]) ||
        draws[i].missing > kMostMissing * 2 * settings.pairs) {
      result.missing = "whether the movement reaches it depends on noise";
      continue;
    }
    const double smoothing = wide.of_calm[i] - calm_values[i], mean = draws[i].mean();
    result.value = values[i] - smoothing - mean;
    result.noise_sd = growth * draws[i].sd();
    // What is left after the correction is less than what was corrected.
    result.corrections = {settings.times_smoothing * smoothing, mean};
    const double narrowing = narrow.of_samples[i] - values[i] -
                             (narrow.of_calm[i] - wide.of_calm[i]) - narrowings[i].mean();
    if (std::isfinite(narrowing) && narrowings[i].missing <= kMostMissing * settings.pairs) {
      result.contradiction = narrowing;
      result.contradiction_sd = narrowings[i].sd();
    }
    if (!is_abrupt.empty() && !std::isfinite(of_abrupt[i])) {
      result.missing = "a movement shorter than the smoothing decides on it";
      result.is_hidden = true;
    } else if (!is_abrupt.empty()) {
      const double change = of_abrupt[i] - values[i] - (of_calm_abrupt[i] - wide.of_calm[i]);
      const double explained = 2 * result.contradiction_sd;
      if (change * change > result.contradiction * result.contradiction - explained * explained) {
        result.contradiction = change;
        result.contradiction_sd = 0;
      }
    }
    for (const double change : result.fixed) {
      if (!std::isfinite(change))
        result.missing = "whether the movement reaches it depends on the landmarks";
    }
    if (!result.missing.empty()) result.value = JawReading::kNone;
  }
  return results;
}

}  // namespace condyle::host
