// SPDX-License-Identifier: Apache-2.0
// Recordings of named points on the kinematic jaw, on a head that moves, and on a pointer.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "condyle/estimator/pose/rotation_vector.h"
#include "readings/landmark_taking.h"
#include "readings/simulated_readings.h"
#include "simulation/kinematic/kinematic_jaw.h"
#include "statistics/random.h"

namespace condyle::host {

/// Named points as a recording.
class PointRecording final : public NamedPointsRecording {
 public:
  explicit PointRecording(const NamedPoints& points) : points_(points), now_m_(3, 0) {
    info_.format = "simulation";
    info_.kind = SampleKind::three_points;
  }
  bool next(Sample& sample) override {
    if (next_ == points_.time_s.size()) return false;
    sample = Sample{};
    sample.kind = SampleKind::three_points;
    sample.time_ns = nanoseconds(points_.time_s[next_]);
    now_m_ = points_.points_m[next_++];
    return true;
  }
  const std::vector<std::string>& names() const override { return points_.names; }
  const Eigen::Matrix3Xd& points_m() const override { return now_m_; }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return "simulation"; }
  double progress() const override { return 0; }

 private:
  const NamedPoints& points_;
  RecordingInfo info_;
  Eigen::Matrix3Xd now_m_;
  std::size_t next_ = 0;
};

inline Eigen::Vector3d random_vector(RandomGenerator& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

inline Eigen::Isometry3d rigid_motion(const Eigen::Vector3d& turn_rad,
                                      const Eigen::Vector3d& shift_m) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = rotation_of<double>(turn_rad);
  motion.translation() = shift_m;
  return motion;
}

/// Points scattered about `middle_m` with `size_m`; far enough from a line.
inline PointColumns random_points(int count, const Eigen::Vector3d& middle_m, double size_m,
                                  RandomGenerator& random) {
  while (true) {
    PointColumns points_m(3, count);
    for (int i = 0; i < count; ++i) points_m.col(i) = size_m * random_vector(random);
    // Also without any one of them.
    bool is_good = true;
    for (int left_out = -1; left_out < (count > 3 ? count : 0); ++left_out) {
      PointColumns rest_m = points_m;
      if (left_out >= 0) rest_m.col(left_out).setConstant(std::nan(""));
      const BodyFit fit = PointBody(points_m).fit(rest_m);
      is_good = is_good && fit.is_fitted && fit.growth < 3.5;
    }
    if (is_good) return points_m.colwise() + middle_m;
  }
}

/// A head that moves by up to 20 mm and 20 deg, from `begin_s` on.
class MovingHead {
 public:
  MovingHead(double begin_s, RandomGenerator& random) : begin_s_(begin_s) {
    for (Wave& wave : waves_) {
      wave = {random_vector(random).normalized(), random_vector(random).normalized(),
              0.1 + 0.4 * random.uniform(), 2 * std::numbers::pi * random.uniform()};
    }
    mounting_ = rigid_motion(0.5 * random_vector(random), 0.1 * random_vector(random));
  }
  /// In the instrument's frame.
  Eigen::Isometry3d at(double time_s) const {
    const double since_s = std::max(time_s - begin_s_, 0.0);
    const double share =
        since_s < 1 ? since_s * since_s * since_s * (10 - 15 * since_s + 6 * since_s * since_s) : 1;
    Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero(), shift_m = Eigen::Vector3d::Zero();
    for (const Wave& wave : waves_) {
      const double size =
          share / 2 * std::sin(2 * std::numbers::pi * wave.rate_Hz * time_s + wave.phase_rad);
      turn_rad += size * 20 * std::numbers::pi / 180 * wave.turn;
      shift_m += size * 0.02 * wave.shift;
    }
    return mounting_ * rigid_motion(turn_rad, shift_m);
  }

 private:
  struct Wave {
    Eigen::Vector3d turn, shift;
    double rate_Hz = 0, phase_rad = 0;
  };
  double begin_s_;
  Wave waves_[2];
  Eigen::Isometry3d mounting_;
};

/// Names with a letter and a number from 1.
inline std::vector<std::string> numbered(char letter, int count) {
  std::vector<std::string> names;
  for (int i = 1; i <= count; ++i) names.push_back(letter + std::to_string(i));
  return names;
}

/// Adds `noise_m` to each coordinate of the points in `points_m`, in the order of the names.
inline void add_noise(PointColumns& points_m, double noise_m, RandomGenerator& random) {
  for (Eigen::Index i = 0; i < points_m.cols(); ++i) {
    points_m.col(i) += noise_m * random_vector(random);
  }
}

}  // namespace condyle::host
