// SPDX-License-Identifier: Apache-2.0
// Helpers of the readings of a stroke.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "readings/path_measures.h"
#include "readings/reading.h"

namespace condyle::host {

/// The readings that are being made: values go in the order of readings_of_stroke.
class ReadingValues {
 public:
  ReadingValues(std::vector<double>& values, std::vector<std::string>* why)
      : values_(values), why_(why) {
    values_.clear();
    if (why_ != nullptr) why_->clear();
  }
  template <class Reason>
  void add(double value, const Reason& reason) {
    values_.push_back(value);
    if (why_ != nullptr) why_->push_back(std::isfinite(value) ? std::string() : reason());
  }
  void add(double value) { add(value, not_computed); }
  /// A greatest value in units of `unit`. How far it lies below the highest sample is kept.
  void add_top(const Greatest& top, double unit) {
    add(top.value / unit);
    keep_shortfall(shortfall_of(top) / unit);
  }
  /// `reading(k)` at the greatest of `values`. Keeps how far it differs at samples that may be the
  /// greatest, and returns it. These lie below the highest by at most `below`, or twice the
  /// shortfall of `top` if that is more.
  template <class Reading, class Reason>
  double add_at_top(const Greatest& top, const std::vector<double>& values, const Reading& reading,
                    const Reason& reason, double below = 0) {
    const double at_top = reading(top.at);
    const double least = top.highest - std::max(2 * shortfall_of(top), below);
    double farthest = 0;
    for (std::size_t k = 0; k < values.size() && std::isfinite(at_top); ++k) {
      if (values[k] >= least) farthest = std::max(farthest, std::abs(reading(k) - at_top));
    }
    add(at_top, reason);
    keep_shortfall(farthest);
    return farthest;
  }
  template <class Reading>
  void add_at_top(const Greatest& top, const std::vector<double>& values, const Reading& reading) {
    add_at_top(top, values, reading, not_computed);
  }
  void keep_shortfall(double shortfall) { shortfalls_.push_back(shortfall); }
  /// Adds what was kept, in the order of the readings (shortfalls.h).
  void add_shortfalls() {
    for (const double shortfall : shortfalls_) add(shortfall);
    shortfalls_.clear();
  }

 private:
  static std::string not_computed() { return "it could not be computed"; }

  std::vector<double>& values_;
  std::vector<std::string>* why_;
  std::vector<double> shortfalls_;
};

/// A reading of a stroke of some kind, and its side.
struct StrokeReading {
  std::string_view name;
  Side side = Side::none;
};

/// Smoothing of a stroke's greatest values (s).
inline constexpr double kTopReach_s = 0.12;
inline double top_reach_s(const JawPath& path, double reach_s = kTopReach_s) {
  constexpr double kNoReach_s = 1e-9;
  return path.is_exact ? kNoReach_s : reach_s;
}

inline std::vector<double> sizes_of(const Points& points) {
  std::vector<double> sizes;
  sizes.reserve(points.size());
  for (const Eigen::Vector3d& point : points) sizes.push_back(point.norm());
  return sizes;
}

/// Distance from the origin in the sagittal plane. The lengths of a jaw cannot overflow, so that
/// std::hypot, which is ten times as slow, is not needed.
inline constexpr auto sagittal_size = [](const Eigen::Vector3d& point) {
  return std::sqrt(point.x() * point.x() + point.z() * point.z());
};

inline std::vector<double> sagittal_sizes_of(const Points& points) {
  std::vector<double> sizes;
  sizes.reserve(points.size());
  for (const Eigen::Vector3d& point : points) sizes.push_back(sagittal_size(point));
  return sizes;
}

inline std::vector<double> coordinate_of(const Points& points, int axis, double sign) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Eigen::Vector3d& point : points) values.push_back(sign * point[axis]);
  return values;
}

inline Greatest top_of(const JawPath& path, const std::vector<double>& values) {
  return greatest_of(path.time_s, values, 0, values.size(), top_reach_s(path));
}

}  // namespace condyle::host
