// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/kinematic_simulation.h"

#include <fmt/format.h>

#include <numbers>
#include <utility>

#include "condyle/estimator/math/elementary.h"
#include "hosted/files/input_error.h"
#include "simulation/kinematic/fork_facebow.h"

namespace condyle::host {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::uint64_t kLandmarkStream = 13;
constexpr double kMostSamples = 3e6;

// About x, then y, then z.
Matrix3d turned(const double (&angles_deg)[3]) {
  Matrix3d result = Matrix3d::Identity();
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    const double angle_rad = angles_deg[axis] * (std::numbers::pi / 180);
    const double s = elementary::sin(angle_rad), c = elementary::cos(angle_rad);
    Matrix3d turn = Matrix3d::Identity();
    turn(j, j) = turn(k, k) = c;
    turn(j, k) = -s;
    turn(k, j) = s;
    result = turn * result;
  }
  return result;
}

JawPose operator*(const JawPose& a, const JawPose& b) {
  return {a.rotation * b.rotation, a.rotation * b.translation_m + a.translation_m};
}

JawPose inverse(const JawPose& pose) {
  return {pose.rotation.transpose(), -(pose.rotation.transpose() * pose.translation_m)};
}

// The fork in A at the reference position.
JawPose fork_pose(const JawMounting& mounting) {
  Matrix3d axes;  // x left, y up, z anterior
  axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  JawPose fork;
  fork.rotation = turned(mounting.fork_rotation_deg) * axes;
  fork.translation_m =
      1e-3 * Vector3d(mounting.fork_mm[0], mounting.fork_mm[1], mounting.fork_mm[2]) -
      fork.rotation * fork_points_m().rowwise().mean();
  return fork;
}

JawLandmarks seen_from(const JawPose& frame, const JawLandmarks& points) {
  const auto moved = [&frame](const Vector3d& point_m) -> Vector3d {
    return frame.rotation * point_m + frame.translation_m;
  };
  return {moved(points.condyle_left), moved(points.condyle_right), moved(points.incisor_lower),
          moved(points.plane_left),   moved(points.plane_right),   moved(points.plane_front)};
}

JawLandmarks with_errors(JawLandmarks points, const LandmarkErrors& errors, std::uint64_t seed) {
  RandomGenerator random(seed, kLandmarkStream);
  const auto err = [&random](Vector3d& point_m, double sd_mm) {
    for (int i = 0; i < 3; ++i) point_m[i] += 1e-3 * sd_mm * random.normal();
  };
  err(points.condyle_left, errors.condyle_sd_mm);
  err(points.condyle_right, errors.condyle_sd_mm);
  err(points.incisor_lower, errors.incisor_sd_mm);
  err(points.plane_left, errors.plane_sd_mm);
  err(points.plane_right, errors.plane_sd_mm);
  err(points.plane_front, errors.plane_sd_mm);
  return points;
}

}  // namespace

KinematicSimulation::KinematicSimulation(const JawScenario& scenario, std::uint64_t seed)
    : KinematicSimulation(std::make_shared<const KinematicJaw>(scenario), scenario, seed) {}

KinematicSimulation::KinematicSimulation(std::shared_ptr<const KinematicJaw> jaw,
                                         const JawScenario& scenario, std::uint64_t seed)
    : jaw_(std::move(jaw)) {
  const JawMounting& mounting = scenario.mounting;
  const double* const shift_mm = mounting.translation_mm;
  const JawPose instrument_from_head{turned(mounting.rotation_deg),
                                     1e-3 * Vector3d(shift_mm[0], shift_mm[1], shift_mm[2])};
  const JawPose fork = fork_pose(mounting);
  const double count = jaw_->motion().duration_s() * scenario.facebow.rate_Hz;
  if (count > kMostSamples) {
    throw InputError(scenario.name,
                     fmt::format("has {:.0f} samples, more than memory may hold", count),
                     "make its tasks shorter or reduce rate_Hz");
  }
  ForkFacebow facebow(scenario.facebow, seed);
  while (facebow.next_instant_s() < jaw_->motion().duration_s()) {
    const double instant_s = facebow.next_instant_s();
    const JawPose jaw_pose = jaw_->pose_at(instant_s);
    const JawPose displacement = mounting.is_upper ? inverse(jaw_pose) : jaw_pose;
    facebow.sample(instrument_from_head * displacement * fork, samples_);
    instants_s_.resize(samples_.size(), instant_s);
  }
  true_ = seen_from(instrument_from_head, jaw_->landmarks());
  stated_ = with_errors(true_, scenario.landmarks, seed);
}

}  // namespace condyle::host
