// SPDX-License-Identifier: Apache-2.0
// Measures of paths: greatest values, first passages, lengths, areas.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <type_traits>
#include <vector>

#include "readings/reading_geometry.h"

namespace condyle::host {

using Points = std::vector<Eigen::Vector3d>;

/// Index of the greatest of `values` from `begin` to `end` (without), which must not be empty.
std::size_t greatest_at(const std::vector<double>& values, std::size_t begin, std::size_t end);

/// The greatest of `values` from `begin` to `end` (without), which must not be empty: the instant
/// is the top of their means over a reach on both sides, so that it does not follow the noise, and
/// the value is theirs at that instant.
struct Greatest {
  std::size_t at;  ///< sample nearest to it
  double time_s, value;
  double highest;  ///< of the samples, wherever it is; the means may pass over a short top
};
/// How far it lies below the highest sample; 0: it lies above.
double shortfall_of(const Greatest& top);
Greatest greatest_of(const std::vector<double>& time_s, const std::vector<double>& values,
                     std::size_t begin, std::size_t end, double reach_s);
/// How rough the `values` are around `top`: root of their mean squared distance from a parabola, by
/// least squares over `reach_s` on both sides. 0 of three values or fewer.
double roughness_of(const std::vector<double>& time_s, const std::vector<double>& values,
                    const Greatest& top, double reach_s);

/// The same for many values at the same times, whose weights are computed once.
class GreatestAt {
 public:
  /// Copies nothing: `time_s` must outlive it.
  GreatestAt(const std::vector<double>& time_s, double reach_s);
  Greatest of(const std::vector<double>& values, std::size_t begin, std::size_t end) const;

 private:
  struct Weight {
    double weight;
    double sum;  // of the weights so far, the middle's with them
  };
  const std::vector<double>& time_s_;
  std::vector<std::size_t> first_;  // of each sample's weights
  std::vector<Weight> weights_;
};

/// A point on a path between two samples.
struct Passage {
  std::size_t after;  ///< sample before it
  Eigen::Vector3d point;
  double share;  ///< of the time between the samples
};

/// A coordinate as the measure of first_passage, which then computes no other to find the place.
struct CoordinateOf {
  int axis;
  double operator()(const Eigen::Vector3d& point) const { return point[axis]; }
};

/// Where between 0 and 1 `value(x)` is 0, to 1e-12: it is `at_0` <= 0 at 0 and `at_1` >= 0 at 1.
/// Secants that keep the sign change between them, by the rule of Illinois (Dowell, Jarratt 1971).
template <class Value>
double share_of_passage(double at_0, double at_1, const Value& value) {
  double low = 0, high = 1, at_low = at_0, at_high = at_1, last = 2;
  bool was_low = false, was_high = false;
  for (int i = 0; i < 100 && at_low < 0 && at_high > 0; ++i) {
    const double x = (low * at_high - high * at_low) / (at_high - at_low);
    if (std::abs(x - last) < 1e-12 || high - low < 1e-12) return x;
    last = x;
    const double here = value(x);
    if (here == 0) return x;
    if (here < 0) {
      low = x;
      at_low = here;
      if (was_low) at_high /= 2;
    } else {
      high = x;
      at_high = here;
      if (was_high) at_low /= 2;
    }
    was_low = here < 0;
    was_high = !was_low;
  }
  return at_high == 0 && at_low < 0 ? high : low;
}

/// The first passage, from sample `begin` to `end` (included), of a curve through `points` with
/// the velocities `rates`, where `measure(point)` reaches `level`. Cubic between samples.
template <class Measure>
std::optional<Passage> first_passage(const std::vector<double>& time_s, const Points& points,
                                     const Points& rates, std::size_t begin, std::size_t end,
                                     double level, const Measure& measure) {
  double next = begin < end ? measure(points[begin]) : 0;
  for (std::size_t k = begin; k < end; ++k) {
    const double here = next;
    next = measure(points[k + 1]);
    if (here > level || next < level) continue;
    const double step_s = time_s[k + 1] - time_s[k];
    const auto at = [&](double x) -> Eigen::Vector3d {
      const double y = 1 - x;
      return y * y * (1 + 2 * x) * points[k] + x * x * (1 + 2 * y) * points[k + 1] +
             x * y * step_s * (y * rates[k] - x * rates[k + 1]);
    };
    const auto measured_at = [&](double x) {
      if constexpr (std::is_same_v<Measure, CoordinateOf>) {
        const double y = 1 - x;
        const int i = measure.axis;
        return y * y * (1 + 2 * x) * points[k][i] + x * x * (1 + 2 * y) * points[k + 1][i] +
               x * y * step_s * (y * rates[k][i] - x * rates[k + 1][i]);
      } else {
        return measure(at(x));
      }
    };
    const double share = share_of_passage(here - level, next - level,
                                          [&](double x) { return measured_at(x) - level; });
    return Passage{k, at(share), share};
  }
  return std::nullopt;
}

/// Length of a path by chords of `chord_m`, point by point.
class PathLength {
 public:
  explicit PathLength(double chord_m) : chord_m_(chord_m) {}
  void begin(const Eigen::Vector3d& point_m);
  void add(const Eigen::Vector3d& point_m);
  /// To the last point, the rest of the last chord with it.
  double length_m() const { return chords_m_ + (last_m_ - from_m_).norm(); }

 private:
  double chord_m_, chords_m_ = 0;
  Eigen::Vector3d from_m_ = Eigen::Vector3d::Zero(), last_m_ = Eigen::Vector3d::Zero();
};

/// Area of the convex hull of the points' coordinates `first` and `second`.
double hull_area(const Points& points, int first, int second);

/// The greatest area that an excursion of the points encloses in the plane of the coordinates
/// `first` and `second`: from where they leave the origin by `near_m` to their next return, or to
/// the end. Parts that turn the other way count negative.
double greatest_loop_m2(const Points& points, int first, int second, double near_m);

/// The finite helical axis of the rotation vector `w_rad` with displacement `d_m` of the point
/// `at_m`.
struct HelicalAxis {
  Eigen::Vector3d direction, point_m;
  double angle_rad, translation_m;
};
HelicalAxis helical_axis(const Eigen::Vector3d& w_rad, const Eigen::Vector3d& at_m,
                         const Eigen::Vector3d& d_m);

/// A pose, rotation vector and displacement of f, and for how long it counts.
struct WeightedPose {
  Eigen::Vector3d rotation_rad, middle_m;
  double weight_s;
};

/// The point of Y = 0 that the `poses` of `path` keep nearest to one place: where the axis about
/// which they turn crosses, by weighted least squares of |R x + t - c| (Ehrig, Taylor, Duda, Heller
/// 2007). Absent if it lies along Y = 0, or if they do not turn.
std::optional<Eigen::Vector3d> hinge_axis_crossing_m(const JawPath& path,
                                                     const std::vector<WeightedPose>& poses);

}  // namespace condyle::host
