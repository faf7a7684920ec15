// SPDX-License-Identifier: Apache-2.0
// Helpers of the readings of a stroke.
#pragma once

#include <Eigen/Core>
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
  void add(double value) {
    add(value, [] { return std::string("it could not be computed"); });
  }

 private:
  std::vector<double>& values_;
  std::vector<std::string>* why_;
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

inline double greatest_mm(const JawPath& path, const std::vector<double>& values_m) {
  return greatest_of(path.time_s, values_m, 0, values_m.size(), top_reach_s(path)).value * 1e3;
}

}  // namespace condyle::host
