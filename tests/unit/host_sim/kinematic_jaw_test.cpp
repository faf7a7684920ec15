// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/kinematic_jaw.h"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr double kRadian = std::numbers::pi / 180;

JawScenario session(std::initializer_list<JawTaskKind> kinds) {
  JawScenario scenario;
  for (const JawTaskKind kind : kinds) scenario.tasks.push_back(default_task(kind));
  return scenario;
}

JawScenario everything() {
  JawScenario scenario =
      session({JawTaskKind::rest, JawTaskKind::opening, JawTaskKind::protrusion, JawTaskKind::left,
               JawTaskKind::right, JawTaskKind::border, JawTaskKind::chewing});
  scenario.anatomy.left = {50, 0.03, 0.6, 6};
  scenario.anatomy.right = {55, 0.035, 0.3, 10};
  scenario.tasks.back().chewing.alternates = true;
  return scenario;
}

Vector3d moved(const JawPose& pose, const Vector3d& point_m) {
  return pose.rotation * point_m + pose.translation_m;
}

template <class Check>
void throughout(const KinematicJaw& jaw, Check check) {
  for (double t = 0; t < jaw.motion().duration_s() + 0.1; t += 0.003) check(t, jaw.pose_at(t));
}

TEST(KinematicJaw, MovesRigidly) {
  const KinematicJaw jaw(everything());
  throughout(jaw, [](double t, const JawPose& pose) {
    const Eigen::Matrix3d error =
        pose.rotation.transpose() * pose.rotation - Eigen::Matrix3d::Identity();
    ASSERT_LT(error.norm(), 1e-13) << t;
    ASSERT_GT(pose.rotation.determinant(), 0) << t;
  });
}

TEST(KinematicJaw, KeepsTheCondylesOnTheirFossae) {
  JawScenario scenario = everything();
  scenario.anatomy.plane_tilt_deg = 7;
  const KinematicJaw jaw(scenario);
  const Eigen::Matrix3d fossae_from_head = jaw.head_from_fossae().transpose();
  throughout(jaw, [&](double t, const JawPose& pose) {
    const auto expect = [&](const Vector3d& condyle_m, const CondylarPath& path) {
      const Vector3d c_mm = 1e3 * (fossae_from_head * moved(pose, condyle_m));
      const double x = c_mm.x();
      ASSERT_NEAR(c_mm.z(),
                  path.curvature_per_mm * x * x - std::tan(path.inclination_deg * kRadian) * x,
                  1e-9)
          << t;
      ASSERT_GE(x, -1e-12) << t;
    };
    expect(jaw.landmarks().condyle_left, scenario.anatomy.left);
    expect(jaw.landmarks().condyle_right, scenario.anatomy.right);
  });
}

TEST(KinematicJaw, MovesTheOrbitingCondyleInwardsAlongItsPath) {
  const JawScenario scenario = everything();
  const KinematicJaw jaw(scenario);
  const CondylarPath& path = scenario.anatomy.right;
  for (const JawStroke& stroke : jaw.motion().strokes()) {
    if (stroke.kind != JawTaskKind::left) continue;
    for (double t = stroke.begin_s; t < stroke.end_s; t += 0.01) {
      const Vector3d c_mm = 1e3 * (moved(jaw.pose_at(t), jaw.landmarks().condyle_right) -
                                   jaw.landmarks().condyle_right);
      const double x = c_mm.x();
      ASSERT_NEAR(c_mm.y(),
                  path.immediate_shift_mm * (1 - std::exp(-x / 0.4)) +
                      x * std::tan(path.progressive_shift_deg * kRadian),
                  1e-9);
    }
  }
}

TEST(KinematicJaw, StandsInTheReferencePositionBetweenTasks) {
  const KinematicJaw jaw(everything());
  for (const JawTaskSpan& task : jaw.motion().tasks()) {
    for (const double t : {task.begin_s, task.end_s}) {
      const JawPose pose = jaw.pose_at(t);
      EXPECT_LT((pose.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14) << task.name();
      EXPECT_LT(pose.translation_m.norm(), 1e-15) << task.name();
    }
  }
}

// A jump of the velocity or the acceleration would not shrink with the step.
TEST(KinematicJaw, HasContinuousVelocityAndAcceleration) {
  const KinematicJaw jaw(everything());
  const auto largest_step = [&](int derivative, double h_s) {
    double largest = 0;
    const auto at = [&](double t) { return moved(jaw.pose_at(t), jaw.landmarks().incisor_lower); };
    for (double t = 0.5; t < jaw.motion().duration_s() - 0.5; t += h_s) {
      const Vector3d a = at(t), b = at(t + h_s), c = at(t + 2 * h_s);
      // Differences of neighbouring difference quotients.
      const Vector3d d = derivative == 1
                             ? Vector3d((c - 2 * b + a) / h_s)
                             : Vector3d((at(t + 3 * h_s) - 3 * c + 3 * b - a) / (h_s * h_s));
      largest = std::max(largest, d.norm());
    }
    return largest;
  };
  for (const int derivative : {1, 2}) {
    EXPECT_LT(largest_step(derivative, 0.5e-3), 0.6 * largest_step(derivative, 1e-3)) << derivative;
  }
}

TEST(KinematicJaw, ReachesTheSizesOfItsTasks) {
  JawScenario scenario = session({JawTaskKind::opening});
  scenario.tasks[0].size_spread = 0;
  const KinematicJaw jaw(scenario);
  const JawStroke& stroke = jaw.motion().strokes().at(0);
  const JawPose pose = jaw.pose_at(stroke.outward_end_s);
  EXPECT_NEAR(std::acos((pose.rotation.trace() - 1) / 2) / kRadian, 26, 1e-9);
  EXPECT_NEAR(pose.translation_m.x(), 9.5e-3, 1e-12);
  EXPECT_LT(moved(pose, jaw.landmarks().incisor_lower).z(),
            jaw.landmarks().incisor_lower.z() - 0.04);
}

TEST(KinematicJaw, RefusesToClimbBeyondTheFossa) {
  JawScenario scenario = session({JawTaskKind::opening});
  scenario.name = "far";
  scenario.tasks[0].advance_mm = 25;
  EXPECT_THAT(
      [&] { KinematicJaw{scenario}; },
      testing::ThrowsMessage<InputError>(testing::HasSubstr("its path is lowest after 18.3 mm")));
}

}  // namespace
}  // namespace condyle::host
