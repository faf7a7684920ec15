// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/kinematic_simulation.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "condyle/estimator/pose/rigid_body.h"

namespace condyle::host {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

JawScenario session() {
  JawScenario scenario;
  for (const JawTaskKind kind :
       {JawTaskKind::opening, JawTaskKind::protrusion, JawTaskKind::left, JawTaskKind::right}) {
    scenario.tasks.push_back(default_task(kind));
  }
  scenario.facebow.noise_m = scenario.facebow.noise_rad = 0;
  scenario.mounting = {.rotation_deg = {20, -35, 110}, .translation_mm = {300, -80, 40}};
  return scenario;
}

Matrix3d points_of(const Sample& sample) {
  return Eigen::Map<const Matrix3d>(sample.coordinates);
}

// Displacement of `point_m` from the first sample, by the fork's points alone.
Vector3d shown_displacement_m(const KinematicSimulation& simulation, std::size_t i,
                              const Vector3d& point_m, bool is_inverted = false) {
  const RigidBody<double> fork(points_of(simulation.samples().front()));
  const auto fit = fork.fit(points_of(simulation.samples()[i]));
  EXPECT_EQ(fit.status, PoseStatus::ok);
  if (is_inverted) {
    return fit.pose.rotation.transpose() * (point_m - fit.pose.translation) - point_m;
  }
  return point_of(fit.pose, point_m) - point_m;
}

TEST(KinematicSimulation, ShowsTheForkAsOneRigidBody) {
  JawScenario scenario = session();
  scenario.facebow.noise_m = kCoarseNoise_m;
  scenario.facebow.noise_rad = kCoarseNoise_rad;
  scenario.facebow.glitch_share = 0.02;
  scenario.facebow.smoothing = 0.3;
  const KinematicSimulation simulation(scenario, 3);
  ASSERT_GT(simulation.samples().size(), 1000U);
  ASSERT_EQ(simulation.samples().size(), simulation.instants_s().size());
  for (const Sample& sample : simulation.samples()) {
    const Vector3d distances_m = distances_of<double>(points_of(sample));
    ASSERT_NEAR(distances_m[0], 0.05, 1e-12);
    ASSERT_NEAR(distances_m[1], std::hypot(0.025, 0.030), 1e-12);
    ASSERT_NEAR(distances_m[2], std::hypot(0.025, 0.030), 1e-12);
  }
}

// Whatever the mounting, and whether the fork is on the jaw or on the head, landmarks and samples
// give back the true displacement.
TEST(KinematicSimulation, LandmarksAndSamplesContainTheTrueMotion) {
  for (const bool is_upper : {false, true}) {
    JawScenario scenario = session();
    scenario.mounting.is_upper = is_upper;
    scenario.anatomy.plane_tilt_deg = 5;
    const KinematicSimulation simulation(scenario, 1);
    const JawLandmarks& shown = simulation.stated_landmarks();
    const JawLandmarks& points = simulation.jaw().landmarks();
    for (std::size_t i = 0; i < simulation.samples().size(); i += 7) {
      const JawPose pose = simulation.jaw().pose_at(simulation.instants_s()[i]);
      const auto expect = [&](const Vector3d& shown_m, const Vector3d& point_m) {
        const Vector3d truth_m = pose.rotation * point_m + pose.translation_m - point_m;
        // Axes of A as seen by the instrument, by their definition.
        const Vector3d y0 = (shown.condyle_left - shown.condyle_right).normalized();
        const Vector3d z = (shown.plane_front - shown.plane_left)
                               .cross(shown.plane_right - shown.plane_left)
                               .normalized() *
                           -1;
        Matrix3d axes;
        axes.col(2) = z.dot(shown.incisor_lower - shown.plane_front) < 0 ? z : Vector3d(-z);
        axes.col(1) = (y0 - axes.col(2) * axes.col(2).dot(y0)).normalized();
        axes.col(0) = axes.col(1).cross(axes.col(2));
        const Vector3d seen_m =
            axes.transpose() * shown_displacement_m(simulation, i, shown_m, is_upper);
        ASSERT_LT((seen_m - truth_m).norm(), 1e-12) << i;
      };
      expect(shown.condyle_left, points.condyle_left);
      expect(shown.condyle_right, points.condyle_right);
      expect(shown.incisor_lower, points.incisor_lower);
    }
  }
}

TEST(KinematicSimulation, TruthDoesNotDependOnTheInstrument) {
  JawScenario scenario = session();
  scenario.tasks.resize(1);
  const auto truth = true_readings(KinematicJaw(scenario));
  scenario.mounting = {.rotation_deg = {1, 2, 3}, .is_upper = true};
  scenario.facebow.rate_Hz = 200;
  scenario.landmarks = {1, 1, 1};
  const auto other = true_readings(KinematicSimulation(scenario, 9).jaw());
  ASSERT_EQ(truth.size(), other.size());
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_EQ(truth[i].value, other[i].value);
}

TEST(KinematicSimulation, NoiseMovesAPointAsTheLeverSays) {
  JawScenario scenario;
  scenario.tasks = {default_task(JawTaskKind::rest)};
  scenario.tasks[0].duration_s = 60;
  scenario.facebow.rate_Hz = 200;
  scenario.facebow.noise_m = kCoarseNoise_m;
  scenario.facebow.noise_rad = kCoarseNoise_rad;
  const KinematicSimulation simulation(scenario, 5);
  scenario.facebow.noise_m = scenario.facebow.noise_rad = 0;
  const KinematicSimulation still(scenario, 5);
  const RigidBody<double> fork(points_of(still.samples().front()));
  const Vector3d condyle_m = simulation.true_landmarks().condyle_left;
  Vector3d squares_m2 = Vector3d::Zero();
  for (const Sample& sample : simulation.samples()) {
    const auto fit = fork.fit(points_of(sample));
    squares_m2 += (point_of(fit.pose, condyle_m) - condyle_m).cwiseAbs2();
  }
  const auto count = static_cast<double>(simulation.samples().size());
  const Vector3d expected_m = point_noise_sd_m<double>(
      kCoarseNoise_m, kCoarseNoise_rad, Vector3d(condyle_m - Vector3d(0.1, 0, -0.05)));
  for (int i = 0; i < 3; ++i) {
    // About 12,000 samples: the deviation strays by 0.65 %; 4 of that.
    EXPECT_NEAR(std::sqrt(squares_m2[i] / count) / expected_m[i], 1, 0.026) << i;
  }
}

TEST(KinematicSimulation, SeedsShareTheMotionAndDifferInErrors) {
  JawScenario scenario = session();
  scenario.facebow.noise_m = kFineNoise_m;
  scenario.landmarks.condyle_sd_mm = 1;
  const auto jaw = std::make_shared<const KinematicJaw>(scenario);
  const KinematicSimulation a(jaw, scenario, 1), same(jaw, scenario, 1), b(jaw, scenario, 2);
  const auto gap_m = [](const KinematicSimulation& p, const KinematicSimulation& q) {
    double largest_m = 0;
    for (std::size_t i = 0; i < p.samples().size(); ++i) {
      largest_m = std::max(
          largest_m, (points_of(p.samples()[i]) - points_of(q.samples()[i])).cwiseAbs().maxCoeff());
    }
    return largest_m;
  };
  EXPECT_EQ(gap_m(a, same), 0);
  EXPECT_GT(gap_m(a, b), 1e-6);
  EXPECT_LT(gap_m(a, b), 1e-3);
  EXPECT_EQ(a.stated_landmarks().condyle_left, same.stated_landmarks().condyle_left);
  EXPECT_NE(a.stated_landmarks().condyle_left, b.stated_landmarks().condyle_left);
  EXPECT_EQ(a.stated_landmarks().incisor_lower, b.stated_landmarks().incisor_lower);
}

TEST(KinematicSimulation, ShowsDropoutsAndRepeats) {
  JawScenario scenario = session();
  scenario.tasks.resize(1);
  scenario.facebow.dropout = {2, 0.5};
  scenario.facebow.repeated_share = 0.1;
  scenario.facebow.lost_share = 0.1;
  const KinematicSimulation simulation(scenario, 1);
  int zeros = 0, repeats = 0;
  const auto& samples = simulation.samples();
  for (std::size_t i = 1; i < samples.size(); ++i) {
    zeros += points_of(samples[i]).isZero(0);
    repeats += samples[i].sequence == samples[i - 1].sequence;
  }
  EXPECT_GT(zeros, 15);
  EXPECT_GT(repeats, 10);
}

}  // namespace
}  // namespace condyle::host
