// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/true_readings.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

namespace condyle::host {
namespace {

constexpr double kRadian = std::numbers::pi / 180;

JawScenario everything() {
  JawScenario scenario;
  for (const JawTaskKind kind :
       {JawTaskKind::rest, JawTaskKind::opening, JawTaskKind::protrusion, JawTaskKind::left,
        JawTaskKind::right, JawTaskKind::border, JawTaskKind::chewing}) {
    scenario.tasks.push_back(default_task(kind));
  }
  scenario.anatomy.left = {50, 0.03, 0.6, 6};
  scenario.anatomy.right = {55, 0.035, 0.3, 10};
  scenario.tasks.back().chewing.alternates = true;
  return scenario;
}

const char* mirror_name(const std::string& name) {
  if (name == "left") return "right";
  return name == "right" ? "left" : nullptr;
}

JawScenario mirrored(JawScenario scenario) {
  std::swap(scenario.anatomy.left, scenario.anatomy.right);
  for (JawTask& task : scenario.tasks) {
    if (task.kind == JawTaskKind::left) {
      task.kind = JawTaskKind::right;
    } else if (task.kind == JawTaskKind::right) {
      task.kind = JawTaskKind::left;
    }
    JawSide& first = task.chewing.first_side;
    first = first == JawSide::left ? JawSide::right : JawSide::left;
  }
  return scenario;
}

using Key = std::tuple<std::string, std::string, int, std::string>;
std::map<Key, double> table_of(const std::vector<TrueReading>& readings) {
  std::map<Key, double> table;
  for (const TrueReading& one : readings) {
    EXPECT_TRUE(table.emplace(Key{one.task, one.side, one.stroke, one.reading}, one.value).second)
        << one.task << one.side << one.stroke << one.reading;
  }
  return table;
}

TEST(TrueReadings, MirrorWithTheSubject) {
  const auto table = table_of(true_readings(KinematicJaw(everything())));
  const auto mirror = table_of(true_readings(KinematicJaw(mirrored(everything()))));
  ASSERT_EQ(table.size(), mirror.size());
  ASSERT_GT(table.size(), 200U);
  for (const auto& [key, value] : table) {
    Key other = key;
    if (const char* name = mirror_name(std::get<0>(key))) std::get<0>(other) = name;
    if (const char* name = mirror_name(std::get<1>(key))) std::get<1>(other) = name;
    const auto found = mirror.find(other);
    ASSERT_NE(found, mirror.end()) << std::get<0>(key) << ' ' << std::get<3>(key);
    const std::string& name = std::get<3>(key);
    const bool is_signed = name == "laterality_index" || name.ends_with("_difference_mm") ||
                           name == "opening_deflection_mm" || name == "opening_deviation_mm";
    EXPECT_NEAR(found->second, is_signed ? -value : value, 1e-6 * std::max(1.0, std::abs(value)))
        << std::get<0>(key) << ' ' << name;
  }
}

// The chord of z = -(tan(a) x - k x^2) to travel s has the slope tan(a) - k x, x sqrt(1 + slope^2)
// = s.
double chord_deg(const CondylarPath& path, double travel_mm, double plane_tilt_deg) {
  double x_mm = travel_mm;
  const auto slope = [&] {
    return std::tan(path.inclination_deg * kRadian) - path.curvature_per_mm * x_mm;
  };
  for (int i = 0; i < 200; ++i) x_mm = travel_mm / std::sqrt(1 + slope() * slope());
  return std::atan(slope()) / kRadian - plane_tilt_deg;
}

TEST(TrueReadings, InclinationFollowsFromThePath) {
  JawScenario scenario = everything();
  scenario.anatomy.plane_tilt_deg = 6;
  for (JawTask& task : scenario.tasks) task.size_spread = 0;  // all reach 10 mm
  const auto table = table_of(true_readings(KinematicJaw(scenario)));
  for (const int travel_mm : {3, 5, 10}) {
    const std::string name = "condylar_inclination_" + std::to_string(travel_mm) + "mm_deg";
    const double left_deg = chord_deg(scenario.anatomy.left, travel_mm, 6);
    for (const int stroke : {0, 1, 2, 3}) {
      EXPECT_NEAR(table.at({"protrusion", "left", stroke, name}), left_deg, 1e-6) << travel_mm;
      EXPECT_NEAR(table.at({"right", "left", stroke, name}), left_deg, 1e-6) << travel_mm;
    }
    EXPECT_NEAR(table.at({"protrusion", "right", 0, name}),
                chord_deg(scenario.anatomy.right, travel_mm, 6), 1e-6);
  }
  EXPECT_NEAR(table.at({"right", "left", 0, "fischer_angle_5mm_deg"}), 0, 1e-9);
}

TEST(TrueReadings, FischerAngleIsTheSteeperPathOfTheOrbitingCondyle) {
  JawScenario scenario = everything();
  scenario.anatomy.left.fischer_deg = 5;
  CondylarPath steeper = scenario.anatomy.left;
  steeper.inclination_deg += 5;
  const auto table = table_of(true_readings(KinematicJaw(scenario)));
  EXPECT_NEAR(table.at({"right", "left", 0, "fischer_angle_5mm_deg"}),
              chord_deg(steeper, 5, 0) - chord_deg(scenario.anatomy.left, 5, 0), 1e-6);
}

TEST(TrueReadings, MedialPathGivesShiftAndBennettAngle) {
  const JawScenario scenario = everything();
  const auto table = table_of(true_readings(KinematicJaw(scenario)));
  const CondylarPath& path = scenario.anatomy.right;
  const double progressive = std::tan(path.progressive_shift_deg * kRadian);
  // The immediate shift is over to 0.7 % at 2 mm, so the line is near y = shift + progressive x.
  EXPECT_NEAR(table.at({"left", "right", 0, "side_shift_mm"}), path.immediate_shift_mm, 2e-3);
  EXPECT_NEAR(table.at({"left", "right", 0, "progressive_side_shift_deg"}),
              path.progressive_shift_deg, 0.03);
  EXPECT_NEAR(table.at({"left", "right", 0, "side_shift_05mm_mm"}),
              path.immediate_shift_mm * (1 - std::exp(-0.5 / 0.4)) + 0.5 * progressive, 1e-9);
  double x_mm = 5;
  for (int i = 0; i < 200; ++i) {
    const double slope = std::tan(path.inclination_deg * kRadian) - path.curvature_per_mm * x_mm;
    x_mm = 5 / std::sqrt(1 + slope * slope);
  }
  const double medial_mm =
      path.immediate_shift_mm * (1 - std::exp(-x_mm / 0.4)) + x_mm * progressive;
  EXPECT_NEAR(table.at({"left", "right", 0, "bennett_angle_5mm_deg"}),
              std::atan2(medial_mm, x_mm) / kRadian, 1e-6);
}

TEST(TrueReadings, OpeningHasItsAngleAndASymmetricPath) {
  JawScenario scenario;
  scenario.tasks = {default_task(JawTaskKind::opening)};
  scenario.tasks[0].size_spread = scenario.tasks[0].duration_spread = 0;
  scenario.translation_delay = 0;
  const auto table = table_of(true_readings(KinematicJaw(scenario)));
  const auto value = [&](const char* reading, const char* side = "") {
    return table.at({"opening", side, 2, reading});
  };
  EXPECT_NEAR(value("opening_angle_deg"), 26, 1e-9);
  EXPECT_NEAR(table.at({"opening", "", 0, "rotation_deg"}), 26, 1e-9);
  EXPECT_NEAR(value("condylar_path_mm", "left"), value("condylar_path_mm", "right"), 1e-9);
  // Length of the parabola from 0.3 mm of travel to x = 9.5 mm, by its integral.
  const double a = std::tan(52 * kRadian), k = 0.035;
  const auto primitive = [&](double x) {
    const double m = a - 2 * k * x;
    return -(m * std::sqrt(1 + m * m) + std::asinh(m)) / (4 * k);
  };
  double start_mm = 0.3;
  for (int i = 0; i < 100; ++i)
    start_mm = 0.3 / std::sqrt(1 + (a - k * start_mm) * (a - k * start_mm));
  // A chord of length c is shorter than its arc by c^3 curvature^2 / 24: in all c^2 / 24 times the
  // integral of curvature^2, here by the midpoint rule.
  double bent_per_mm = 0;
  constexpr int kParts = 1000;
  for (int i = 0; i < kParts; ++i) {
    const double step_mm = (9.5 - start_mm) / kParts,
                 m = a - 2 * k * (start_mm + (i + 0.5) * step_mm);
    bent_per_mm += 4 * k * k / std::pow(1 + m * m, 2.5) * step_mm;
  }
  constexpr double chord_mm = 0.5;
  EXPECT_NEAR(value("condylar_path_mm", "left"),
              primitive(9.5) - primitive(start_mm) - chord_mm * chord_mm / 24 * bent_per_mm, 5e-6);
  EXPECT_NEAR(value("condylar_translation_mm", "left"), std::hypot(9.5, 9.5 * (a - k * 9.5)), 1e-9);
  EXPECT_NEAR(value("opening_peak_speed_mm_s"), value("closing_peak_speed_mm_s"), 1e-3);
}

TEST(TrueReadings, LateralAndProtrusiveStrokesGoWhereTheySay) {
  const auto table = table_of(true_readings(KinematicJaw(everything())));
  EXPECT_GT(table.at({"left", "left", 0, "laterotrusion_mm"}), 6);
  EXPECT_GT(table.at({"right", "right", 0, "laterotrusion_mm"}), 6);
  EXPECT_GT(table.at({"protrusion", "", 0, "protrusion_mm"}), 6);
  EXPECT_EQ(table.at({"rest", "", 0, "rotation_deg"}), 0);
  EXPECT_EQ(table.at({"rest", "", 0, "displacement_mm"}), 0);
}

// Of the incisor, in A.
Eigen::Vector3d displacement_mm(const KinematicJaw& jaw, double time_s) {
  const JawPose pose = jaw.pose_at(time_s);
  const Eigen::Vector3d& incisor_m = jaw.landmarks().incisor_lower;
  return 1e3 * (pose.rotation * incisor_m + pose.translation_m - incisor_m);
}

TEST(TrueReadings, CyclesMeetAtTheMostClosedInstants) {
  const KinematicJaw jaw(everything());
  const std::vector<JawCycle> cycles = true_cycles(jaw);
  ASSERT_GE(cycles.size(), 12U);
  const auto height_mm = [&](double t) { return displacement_mm(jaw, t).z(); };
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const JawCycle& cycle = cycles[i];
    if (i > 0 && cycles[i - 1].sequence == cycle.sequence) {
      EXPECT_EQ(cycle.begin_s, cycles[i - 1].end_s);
    }
    for (double t = cycle.begin_s + 0.02; t < cycle.end_s - 0.02; t += 0.001) {
      ASSERT_LT(height_mm(t), height_mm(cycle.begin_s)) << cycle.cycle << ' ' << t;
    }
    EXPECT_LE(height_mm(cycle.opening_end_s), height_mm(cycle.opening_end_s + 1e-4));
    EXPECT_LE(height_mm(cycle.opening_end_s), height_mm(cycle.opening_end_s - 1e-4));
  }
}

// The path further on the working side is that of closing; that of opening, if the loop is
// reversed.
TEST(TrueReadings, LoopsTurnAsAsked) {
  for (const bool is_reversed : {false, true}) {
    JawScenario scenario;
    scenario.tasks = {default_task(JawTaskKind::chewing)};
    scenario.tasks[0].chewing.alternates = true;
    scenario.tasks[0].chewing.reversed_share = is_reversed ? 1 : 0;
    const KinematicJaw jaw(scenario);
    JawSide last = JawSide::none;
    for (const JawCycle& cycle : true_cycles(jaw)) {
      EXPECT_EQ(cycle.is_reversed, is_reversed);
      EXPECT_NE(cycle.working, last);
      last = cycle.working;
      const double side = cycle.working == JawSide::left ? 1 : -1;
      const auto lateral_mm = [&](double t) { return side * displacement_mm(jaw, t).y(); };
      const double opening_mm = lateral_mm((cycle.begin_s + cycle.opening_end_s) / 2);
      const double closing_mm = lateral_mm((cycle.end_s + cycle.opening_end_s) / 2);
      EXPECT_GT(is_reversed ? opening_mm - closing_mm : closing_mm - opening_mm, 1);
      EXPECT_GT(std::max(opening_mm, closing_mm), 2);
    }
  }
}

TEST(TrueReadings, SwallowsAndSpeechAreSmallAndNoCycles) {
  JawScenario scenario;
  scenario.tasks = {default_task(JawTaskKind::chewing)};
  const KinematicJaw jaw(scenario);
  const std::vector<JawCycle> cycles = true_cycles(jaw);
  const auto next = std::find_if(cycles.begin(), cycles.end(),
                                 [](const JawCycle& cycle) { return cycle.sequence == 2; });
  ASSERT_NE(next, cycles.end());
  double swallow_mm = 0, speech_mm = 0;
  for (double t = std::prev(next)->end_s; t < next->begin_s; t += 0.001) {
    // A swallow is over 2 s after the cycles: 1 s of pause, at most 0.7 s.
    double& most_mm = t < std::prev(next)->end_s + 2 ? swallow_mm : speech_mm;
    most_mm = std::max(most_mm, displacement_mm(jaw, t).norm());
  }
  EXPECT_GT(swallow_mm, 0.9);
  EXPECT_LT(swallow_mm, 3.1);
  EXPECT_GT(speech_mm, 3);
  EXPECT_LT(speech_mm, 5.1);
}

}  // namespace
}  // namespace condyle::host
