// SPDX-License-Identifier: Apache-2.0
#include "readings/axis_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "condyle/estimator/pose/rotation_vector.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr double kNone = JawReading::kNone;
constexpr double kDegree = std::numbers::pi / 180, kMillimetre = 1e-3;
constexpr double kLeastAxisAngle_rad = 5 * kDegree, kHingeFrom_rad = 1 * kDegree,
                 kHingeArc_rad = 12 * kDegree;
constexpr int kSteps = 4;
constexpr double kFastShare = 0.5, kLeastRateSds = 10;
// A greater ratio of the highest rate to the peak of means: a short movement decides which samples
// are fast.
constexpr double kMostAbovePeak = 1.3;

// Where an axis crosses Y = 0; absent if it lies along that plane.
std::optional<Vector3d> crossing_m(const Vector3d& point_m, const Vector3d& direction) {
  if (std::abs(direction.y()) < 0.5 * direction.norm()) return std::nullopt;
  return point_m - direction * (point_m.y() / direction.y());
}

// Crossings with weights: mean, and root of the mean squared distance from it.
class Crossings {
 public:
  void add(const Vector3d& point_m, double weight) {
    points_m_.push_back(point_m);
    weights_.push_back(weight);
    total_ += weight;
    sum_ += weight * point_m;
  }
  template <class Reason>
  void give(const Reason& reason, ReadingValues& out) const {
    Vector3d mean = Vector3d::Constant(kNone);
    double spread_m = kNone;
    if (total_ > 0) {
      mean = sum_ / total_;
      double squares = 0;
      for (std::size_t i = 0; i < points_m_.size(); ++i) {
        squares += weights_[i] / total_ * (points_m_[i] - mean).squaredNorm();
      }
      spread_m = std::sqrt(squares);
    }
    for (const double value_m : {mean.x(), mean.z(), spread_m}) {
      out.add(value_m / kMillimetre, reason);
    }
  }

 private:
  std::vector<Vector3d> points_m_;
  std::vector<double> weights_;
  double total_ = 0;
  Vector3d sum_ = Vector3d::Zero();
};

// A pose: rotation vector, and displacement of the middle.
struct Pose {
  Vector3d rotation_rad = Vector3d::Zero(), middle_m = Vector3d::Zero();
};

// The pose where the twist first reaches `level_rad`.
Pose pose_at(const JawPath& path, const std::vector<double>& twists_rad, std::size_t widest,
             double level_rad) {
  for (std::size_t k = 0; k < widest; ++k) {
    if (twists_rad[k + 1] < level_rad) continue;
    const double step = twists_rad[k + 1] - twists_rad[k];
    const double share = step > 0 ? std::clamp((level_rad - twists_rad[k]) / step, 0.0, 1.0) : 0;
    return {(1 - share) * path.rotation_rad[k] + share * path.rotation_rad[k + 1],
            (1 - share) * path.middle_m[k] + share * path.middle_m[k + 1]};
  }
  return {path.rotation_rad[widest], path.middle_m[widest]};
}

// The pose at `share` of the time between samples `k` and `k` + 1: cubic through four of them.
Pose pose_between(const JawPath& path, std::size_t k, double share) {
  const std::size_t count = path.time_s.size(), points = std::min<std::size_t>(4, count);
  const std::size_t first = std::clamp<std::size_t>(k, 1, count - points + 1) - 1;
  const double at_s = path.time_s[k] + share * (path.time_s[k + 1] - path.time_s[k]);
  Pose pose;
  for (std::size_t i = first; i < first + points; ++i) {
    double weight = 1;
    for (std::size_t j = first; j < first + points; ++j) {
      if (j != i) weight *= (at_s - path.time_s[j]) / (path.time_s[i] - path.time_s[j]);
    }
    pose.rotation_rad += weight * path.rotation_rad[i];
    pose.middle_m += weight * path.middle_m[i];
  }
  return pose;
}

// The poses from one angle to another, each with its share of the time, by Simpson's rule. However
// fast the samples follow each other, the first and the last pose have these angles.
std::vector<WeightedPose> poses_between(const JawPath& path, const std::vector<double>& twists_rad,
                                        std::size_t widest, double from_rad, double to_rad) {
  std::size_t first = widest, last = widest;
  while (first > 0 && twists_rad[first] > from_rad) --first;
  for (std::size_t k = first; k <= widest; ++k) {
    if (twists_rad[k] < to_rad) continue;
    last = k;
    break;
  }
  std::vector<WeightedPose> poses;
  for (std::size_t k = first; k < last; ++k) {
    const auto share_at = [&](double level_rad) {
      return share_of_passage(
          twists_rad[k] - level_rad, twists_rad[k + 1] - level_rad, [&](double share) {
            return twist_about(pose_between(path, k, share).rotation_rad, 1) - level_rad;
          });
    };
    const double begin = k == first && twists_rad[k] < from_rad ? share_at(from_rad) : 0;
    const double end = k + 1 == last && twists_rad[last] > to_rad ? share_at(to_rad) : 1;
    const double length_s = (end - begin) * (path.time_s[k + 1] - path.time_s[k]);
    for (const double part : {0.0, 0.5, 1.0}) {
      const Pose pose = pose_between(path, k, begin + part * (end - begin));
      poses.push_back({pose.rotation_rad, pose.middle_m, length_s * (part == 0.5 ? 4.0 : 1.0) / 6});
    }
  }
  return poses;
}

void add_finite_axes(const JawPath& path, const std::vector<double>& twists_rad, std::size_t widest,
                     ReadingValues& out) {
  Crossings crossings;
  const double step_rad = twists_rad[widest] / kSteps;
  Pose from;
  for (int i = 1; i <= kSteps && step_rad >= kLeastAxisAngle_rad; ++i) {
    const Pose to = pose_at(path, twists_rad, widest, i * step_rad);
    const Eigen::Matrix3d turn =
        rotation_of<double>(to.rotation_rad) * rotation_of<double>(from.rotation_rad).transpose();
    const HelicalAxis axis =
        helical_axis(rotation_vector_of<double>(turn), path.middle_at_m + from.middle_m,
                     to.middle_m - from.middle_m);
    if (const auto point_m = crossing_m(axis.point_m, axis.direction)) crossings.add(*point_m, 1);
    from = to;
  }
  crossings.give(
      [&] {
        return fmt::format("the jaw turns by {:.1f} deg, at least {:.0f} deg are needed",
                           twists_rad[widest] / kDegree, kSteps * kLeastAxisAngle_rad / kDegree);
      },
      out);
}

void add_instantaneous_axes(const JawPath& path, std::size_t widest, double turning_sd_rad_s,
                            ReadingValues& out) {
  Crossings crossings;
  const std::vector<double> rates = sizes_of(path.turning_rad_s);
  const Greatest peak = greatest_of(path.time_s, rates, 0, widest + 1, top_reach_s(path));
  const double fast_rad_s = kFastShare * peak.value;
  const bool is_above_noise = fast_rad_s > kLeastRateSds * turning_sd_rad_s;
  const bool is_short = is_above_noise && peak.highest > kMostAbovePeak * peak.value;
  const bool is_clear = is_above_noise && !is_short;
  const auto crossing_at = [&](std::size_t k) {
    const Vector3d& omega = path.turning_rad_s[k];
    const Vector3d place = path.condyle_at_m[0] + path.condyle_m[0][k];
    const Vector3d point = place + omega.cross(path.condyle_m_s[0][k]) / omega.squaredNorm();
    return crossing_m(point, omega);
  };
  // Integrals by the trapezoidal rule, to the very passages of `fast_rad_s`.
  std::optional<Vector3d> before;
  for (std::size_t k = 1; k <= widest && is_clear; ++k) {
    const bool was_fast = rates[k - 1] >= fast_rad_s, is_fast = rates[k] >= fast_rad_s;
    if (!was_fast) before = is_fast ? crossing_at(k - 1) : std::nullopt;
    if (!was_fast && !is_fast) continue;
    const auto now = crossing_at(k);
    const double share = was_fast == is_fast ? 1
                                             : (rates[is_fast ? k : k - 1] - fast_rad_s) /
                                                   std::abs(rates[k] - rates[k - 1]);
    const double half_s = share * (path.time_s[k] - path.time_s[k - 1]) / 2;
    if (before && now) {
      const Vector3d first = was_fast ? *before : *now + share * (*before - *now);
      const Vector3d last = is_fast ? *now : *before + share * (*now - *before);
      crossings.add(first, half_s * (was_fast ? rates[k - 1] : fast_rad_s));
      crossings.add(last, half_s * (is_fast ? rates[k] : fast_rad_s));
    }
    before = now;
  }
  crossings.give(
      [&] {
        if (is_short) return std::string("the jaw turns fastest in a movement of less than 0.12 s");
        return fmt::format(
            "half of the peak rate of turning, {:.1f} deg/s, is below 10 sd of the rate, {:.1f} "
            "deg/s",
            fast_rad_s / kDegree, kLeastRateSds * turning_sd_rad_s / kDegree);
      },
      out);
}

// Of the axis from the reference position to sample `k`; NaN if the jaw turns too little.
Vector3d helical_crossing_m(const JawPath& path, const std::vector<double>& twists_rad,
                            std::size_t k) {
  if (twists_rad[k] >= kLeastAxisAngle_rad) {
    const HelicalAxis axis = helical_axis(path.rotation_rad[k], path.middle_at_m, path.middle_m[k]);
    if (std::abs(axis.direction.y()) > 0.5) {
      return axis.point_m - axis.direction * (axis.point_m.y() / axis.direction.y());
    }
  }
  return Vector3d::Constant(kNone);
}

}  // namespace

void add_axis_names(std::vector<StrokeReading>& names) {
  for (const char* name :
       {"hinge_axis_x_mm", "hinge_axis_z_mm", "helical_axis_x_mm", "helical_axis_z_mm",
        "finite_axes_x_mm", "finite_axes_z_mm", "finite_axes_spread_mm", "instantaneous_axis_x_mm",
        "instantaneous_axis_z_mm", "instantaneous_axis_spread_mm"}) {
    names.push_back({name});
  }
}

void hide_unknown_axes(const std::vector<StrokeReading>& names,
                       std::vector<UncertainValue>& values) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!names[i].name.starts_with("instantaneous_axis_")) continue;
    values[i].is_hidden = !std::isfinite(values[i].value);
  }
}

void add_axes(const JawPath& path, const std::vector<double>& twists_rad, const Greatest& twist,
              double turning_sd_rad_s, ReadingValues& out) {
  const std::size_t widest = twist.at;
  Vector3d crossing = Vector3d::Constant(kNone);
  const auto too_little = [&] {
    return fmt::format("the jaw turns by {:.1f} deg, at least {:.0f} deg are needed",
                       twists_rad[widest] / kDegree, kLeastAxisAngle_rad / kDegree);
  };
  if (twists_rad[widest] >= kLeastAxisAngle_rad) {
    // The beginning of the opening, as far as the hinge phase goes.
    const auto hinge = hinge_axis_crossing_m(
        path, poses_between(path, twists_rad, widest, kHingeFrom_rad, kHingeArc_rad));
    if (hinge) crossing = *hinge;
  }
  out.add(crossing.x() / kMillimetre, too_little);
  out.add(crossing.z() / kMillimetre, too_little);
  for (const int axis : {0, 2}) {
    out.add_at_top(
        twist, twists_rad,
        [&](std::size_t k) { return helical_crossing_m(path, twists_rad, k)[axis] / kMillimetre; },
        too_little);
  }
  add_finite_axes(path, twists_rad, widest, out);
  add_instantaneous_axes(path, widest, turning_sd_rad_s, out);
}

}  // namespace condyle::host
