// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/fork_facebow.h"

#include "condyle/estimator/math/elementary.h"

namespace condyle::host {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

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
  for (int point = 0; point < 3; ++point) {
    points_m.col(point) = Vector3d::Map(kFacebowPoints_m[point].data());
  }
  return points_m;
}

ForkFacebow::ForkFacebow(const FacebowModel& model, std::uint64_t seed)
    : model_(model), noise_(seed, 1), faults_(model, seed) {}

void ForkFacebow::sample(const JawPose& fork, std::vector<Sample>& samples) {
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
  if (const auto glitch_m = faults_.draw_glitch_m()) {
    now.centroid_m += Vector3d::Map(glitch_m->data());
  }
  if (faults_.is_frozen() && shown_) now = *shown_;
  shown_ = now;

  Sample sample;
  sample.kind = SampleKind::three_points;
  for (int point = 0; point < 3; ++point) {
    const Vector3d at_m = now.turn * (points_m.col(point) - centre_m) + now.centroid_m;
    for (int i = 0; i < 3; ++i) sample.coordinates[3 * point + i] = faults_.shown_m(at_m[i]);
  }
  faults_.deliver(sample, samples);
}

}  // namespace condyle::host
