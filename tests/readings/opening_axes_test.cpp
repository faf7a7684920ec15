// SPDX-License-Identifier: Apache-2.0
// Axes of turning and kinematic centres on exact poses, where they are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "readings/kinematic_centre.h"
#include "readings/path_measures.h"
#include "readings/simulated_readings.h"
#include "readings/stroke_readings.h"

namespace condyle::host {
namespace {

TEST(HelicalAxis, IsThatOfATurnAboutAKnownLine) {
  const Eigen::Vector3d point(0.01, 0.02, -0.03), at(0.1, 0, -0.05);
  const Eigen::Vector3d direction = Eigen::Vector3d(0.1, 1, 0.2).normalized();
  const Eigen::Matrix3d R = rotation_of<double>(0.3 * direction);
  const Eigen::Vector3d moved = R * (at - point) + point + 0.002 * direction;
  const HelicalAxis axis = helical_axis(0.3 * direction, at, moved - at);
  EXPECT_NEAR(axis.angle_rad, 0.3, 1e-12);
  EXPECT_NEAR(axis.translation_m, 0.002, 1e-12);
  EXPECT_LT(direction.cross(axis.point_m - point).norm(), 1e-12);
}

// About a line that is not parallel to Y, there and back in 6 s. Poses between samples lie on
// chords.
TEST(OpeningAxes, OfATurnAboutAKnownLineAreThatLine) {
  const Eigen::Vector3d crosses_m(-3e-3, 0, -7e-3);
  const Eigen::Vector3d direction = Eigen::Vector3d(0.05, 1, -0.1).normalized();
  ReadingGeometry geometry;
  geometry.has_landmarks = true;
  geometry.incisor_m = {0.08, 0.001, -0.04};
  geometry.condyle_m = {Eigen::Vector3d(0, 0.055, 0), Eigen::Vector3d(0, -0.055, 0)};
  geometry.middle_m = {0.1, 0, -0.05};
  SmoothMotion motion;
  for (int i = 0; i <= 12000; ++i) {
    const double phase = 2 * std::numbers::pi * i / 12000.0;
    const Eigen::Vector3d turn_rad = 0.2 * (1 - std::cos(phase)) * direction;
    const Eigen::Vector3d turning_rad_s = 0.4 * std::numbers::pi / 6 * std::sin(phase) * direction;
    const Eigen::Matrix3d R = rotation_of<double>(turn_rad);
    const Eigen::Vector3d arm_m = R * (geometry.middle_m - crosses_m);
    Vector6 value, slope;
    value << arm_m + crosses_m - geometry.middle_m, turn_rad;
    slope << turning_rad_s.cross(arm_m), turning_rad_s;
    motion.time_s.push_back(i / 2000.0);
    motion.value.push_back(value);
    motion.slope.push_back(slope);
  }
  JawPath path;
  path.is_exact = true;
  paths_of(motion, geometry, path);
  const auto names = readings_of_stroke(TaskKind::opening, true);
  std::vector<double> values;
  read_stroke(TaskKind::opening, true, path, values, nullptr);
  int compared = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string_view name = names[i].name;
    if (name.find("axis_") == name.npos && name.find("axes_") == name.npos) continue;
    const double expected_mm = name.ends_with("_x_mm")   ? 1e3 * crosses_m.x()
                               : name.ends_with("_z_mm") ? 1e3 * crosses_m.z()
                                                         : 0;  // spread
    EXPECT_NEAR(values[i], expected_mm, 1e-6) << name;
    ++compared;
  }
  EXPECT_EQ(compared, 10);
}

// From little noise to much, so that in some recordings the axes of some openings are known and
// those of slower ones are not.
TEST(InstantaneousAxes, HaveNoMeanOfTheFastOpeningsAlone) {
  int partly_known = 0;
  for (int run = 0; run < 40; ++run) {
    JawScenario scenario;
    scenario.tasks = {default_task(JawTaskKind::rest), default_task(JawTaskKind::opening)};
    scenario.motion_seed = 80 + static_cast<std::uint64_t>(run);
    scenario.facebow.rate_Hz = 100;
    scenario.facebow.noise_m = kFineNoise_m;
    scenario.facebow.noise_rad = 3e-4 * std::pow(1.06, run);
    scenario.landmarks = {1, 1, 1};
    const KinematicSimulation simulation(scenario, scenario.motion_seed);
    SampleRecording recording(simulation.samples());
    AnalysisChoice choice;
    choice.tasks = stated_tasks(simulation);
    const Analysis analysis =
        analyse(recording, "simulation", stated_landmarks(simulation, scenario.landmarks), choice);
    int strokes = 0, unknown = 0;
    bool is_mean_shown = false;
    for (const JawReading& reading : analysis.readings) {
      if (reading.definition->name != "instantaneous_axis_z_mm") continue;
      const bool is_shown = reading.provenance != ReadingProvenance::withheld;
      if (reading.stroke == 0) {
        is_mean_shown = is_shown;
      } else {
        ++strokes;
        unknown += reading.reason.find("10 sd of the rate") == reading.reason.npos ? 0 : 1;
      }
    }
    ASSERT_GT(strokes, 2);
    partly_known += 0 < unknown && unknown < strokes ? 1 : 0;
    if (unknown > 0) {
      EXPECT_FALSE(is_mean_shown) << run << ": " << unknown << " of " << strokes;
    }
  }
  EXPECT_GT(partly_known, 0);
}

// The axis moves while the jaw opens. Where its arc begins and ends must not follow the samples:
// at 60 Hz the angle grows by 2 deg from one to the next.
TEST(HingeAxis, IsTheSameAtEveryRate) {
  JawScenario scenario;
  scenario.tasks = {default_task(JawTaskKind::opening)};
  const KinematicJaw jaw(scenario);
  const auto names = readings_of_stroke(TaskKind::opening, true);
  double worst_mm = 0;
  for (const JawStroke& stroke : jaw.motion().strokes()) {
    const auto hinge_mm = [&](double rate_Hz, double offset) {
      std::vector<double> values;
      read_stroke(
          TaskKind::opening, true,
          exact_path(jaw, stroke.begin_s - 0.1 + offset / rate_Hz, stroke.end_s + 0.1, 1 / rate_Hz),
          values, nullptr);
      Eigen::Vector2d place_mm(JawReading::kNone, JawReading::kNone);
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i].name == "hinge_axis_x_mm") place_mm.x() = values[i];
        if (names[i].name == "hinge_axis_z_mm") place_mm.y() = values[i];
      }
      return place_mm;
    };
    const Eigen::Vector2d true_mm = hinge_mm(2000, 0);
    for (const double rate_Hz : {60.0, 75.0, 100.0, 200.0, 500.0}) {
      for (const double offset : {0.0, 0.2, 0.4, 0.6, 0.8}) {
        const double error_mm = (hinge_mm(rate_Hz, offset) - true_mm).norm();
        EXPECT_LT(error_mm, 0.005) << rate_Hz << " Hz, from " << offset << " of a sample";
        worst_mm = std::max(worst_mm, error_mm);
      }
    }
  }
  EXPECT_GT(worst_mm, 0);
  std::printf("hinge axis: %.2g mm at most\n", worst_mm);
}

TEST(KinematicCentre, IsTheCondyleOnExactPoses) {
  JawScenario scenario;
  scenario.tasks = {default_task(JawTaskKind::opening), default_task(JawTaskKind::protrusion)};
  scenario.anatomy.left = {50, 0.03, 0.6, 6};
  const KinematicJaw jaw(scenario);
  std::optional<JawPath> opened, protruded;
  for (const JawStroke& stroke : jaw.motion().strokes()) {
    auto& path = stroke.kind == JawTaskKind::opening ? opened : protruded;
    if (!path) path = exact_path(jaw, stroke.begin_s - 0.1, stroke.end_s + 0.1);
  }
  ASSERT_TRUE(opened && protruded);
  for (const std::size_t side : {0U, 1U}) {
    const auto centre_m = centre_of_pair_m(*opened, *protruded, side);
    ASSERT_TRUE(centre_m);
    EXPECT_NEAR(1e3 * centre_m->x(), 0, 1e-6) << side;
    EXPECT_NEAR(1e3 * centre_m->y(), 0, 1e-6) << side;
  }
}

}  // namespace
}  // namespace condyle::host
