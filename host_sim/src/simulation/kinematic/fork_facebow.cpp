// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/fork_facebow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "condyle/estimator/math/elementary.h"

namespace condyle::host {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kSmallestGlitch_m = 0.003, kLargestGlitch_m = 0.008;

Vector3d three_normals(RandomGenerator& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

Quaterniond turn_by(const Vector3d& rotation_rad) {
  const double angle_rad = rotation_rad.norm();
  if (angle_rad == 0) return Quaterniond::Identity();
  const Vector3d part = elementary::sin(angle_rad / 2) / angle_rad * rotation_rad;
  return {elementary::cos(angle_rad / 2), part.x(), part.y(), part.z()};
}

}  // namespace

Eigen::Matrix3d fork_points_m() {
  Eigen::Matrix3d points_m;
  points_m << 0, 0.025, -0.025, 0, 0, 0, 0, 0.030, 0.030;
  return points_m;
}

ForkFacebow::ForkFacebow(const FacebowModel& model, std::uint64_t seed)
    : model_(model), noise_(seed, 1), faults_(seed, 2), times_(seed, 3) {
  schedule();
}

void ForkFacebow::schedule() {
  const double jitter_s = model_.jitter_s * times_.normal();
  next_instant_s_ =
      std::max(next_instant_s_, static_cast<double>(count_) / model_.rate_Hz + jitter_s);
}

Vector3d ForkFacebow::draw_glitch_m() {
  const double size_m =
      kSmallestGlitch_m + (kLargestGlitch_m - kSmallestGlitch_m) * faults_.uniform();
  const double height = 2 * faults_.uniform() - 1, angle = 2 * std::numbers::pi * faults_.uniform();
  const double across = std::sqrt(1 - height * height);
  return size_m *
         Vector3d(across * elementary::cos(angle), across * elementary::sin(angle), height);
}

void ForkFacebow::sample(const JawPose& fork, std::vector<Sample>& samples) {
  const double instant_s = next_instant_s_;
  const Eigen::Matrix3d points_m = fork_points_m();
  const Vector3d centre_m = points_m.rowwise().mean();
  Placement now{Quaterniond(fork.rotation), fork.rotation * centre_m + fork.translation_m};
  now.centroid_m += model_.noise_m * three_normals(noise_);
  now.turn = turn_by(model_.noise_rad * three_normals(noise_)) * now.turn;
  if (smoothed_ && model_.smoothing > 0) {
    const double share = model_.smoothing;
    if (smoothed_->turn.dot(now.turn) < 0) now.turn.coeffs() *= -1;
    now.turn.coeffs() = share * smoothed_->turn.coeffs() + (1 - share) * now.turn.coeffs();
    now.turn.normalize();
    now.centroid_m = share * smoothed_->centroid_m + (1 - share) * now.centroid_m;
  }
  smoothed_ = now;
  if (faults_.uniform() < model_.glitch_share) now.centroid_m += draw_glitch_m();
  if (model_.frozen.contains(instant_s) && shown_) now = *shown_;
  shown_ = now;

  Sample sample;
  sample.sequence = count_;
  sample.kind = SampleKind::three_points;
  const double regular_s = static_cast<double>(count_) / model_.rate_Hz;
  sample.time_ns = nanoseconds(regular_s * (1 + model_.clock_drift) + model_.latency_s);
  for (int point = 0; point < 3 && !model_.dropout.contains(instant_s); ++point) {
    const Vector3d at_m = now.turn * (points_m.col(point) - centre_m) + now.centroid_m;
    for (int i = 0; i < 3; ++i) {
      const double value_m = at_m[i];
      sample.coordinates[3 * point + i] =
          model_.quantum_m > 0 ? std::floor(value_m / model_.quantum_m + 0.5) * model_.quantum_m
                               : value_m;
    }
  }
  sample.position_valid = !is_out_of_range(sample.kind, sample.coordinates);
  const bool is_lost = faults_.uniform() < model_.lost_share;
  const bool is_repeated = faults_.uniform() < model_.repeated_share;
  if (!is_lost) samples.push_back(sample);
  if (!is_lost && is_repeated) samples.push_back(sample);
  ++count_;
  schedule();
}

}  // namespace condyle::host
