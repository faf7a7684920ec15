// SPDX-License-Identifier: Apache-2.0
#include "simulation/jaw.h"

#include <algorithm>
#include <cmath>

#include "condyle/estimator/math/elementary.h"

namespace condyle::host {
namespace {

constexpr double kGravity_m_s2 = 9.80665;
constexpr double kDegree = 0.017453292519943295;

}  // namespace

double Jaw::followed_position_m(double q) const {
  return geometry().position_m(q);
}

double Jaw::followed_slope(double q) const {
  return geometry().slope(q);
}

double Jaw::followed_curvature(double q) const {
  return motion == JawMotion::translation
             ? 0
             : -incisor_radius_m * elementary::sin(incisor_angle_rad - q);
}

double Jaw::coordinate_at(double position_m) const {
  return geometry().coordinate_at(position_m);
}

double Jaw::weight(double q) const {
  if (motion == JawMotion::translation) return 0;  // these axes are horizontal
  // The height of the centre of mass falls as the jaw opens.
  return mass_kg * kGravity_m_s2 * centre_of_mass_radius_m * elementary::cos(incisor_angle_rad - q);
}

double force_length_factor(const Muscle& muscle, double q) {
  return condyle::force_length_factor(muscle.parameters(), q);
}

double force_velocity_factor(const Muscle& muscle, double q_rate) {
  return condyle::force_velocity_factor(muscle.parameters(), q_rate);
}

Jaw tabulated_hinge_jaw(const std::string& name) {
  Jaw jaw;
  const bool upper = name == "anybody";
  if (upper) {
    jaw.mass_kg = 0.44;
    jaw.inertia_kg_m2 = 4.2e-3;
    jaw.incisor_radius_m = 0.098;
    jaw.incisor_angle_rad = -22 * kDegree;
  } else {
    jaw.incisor_angle_rad = -28 * kDegree;
  }
  // Closing arms are positive in the table; closing drives the opening angle down.
  const auto add = [&](const char* muscle, double low_N, double high_N, double low_arm_mm,
                       double high_arm_mm) {
    jaw.muscles.push_back({.name = muscle,
                           .maximum_force_N = upper ? high_N : low_N,
                           .arm = -1e-3 * (upper ? high_arm_mm : low_arm_mm)});
  };
  add("superficial_masseter", 190, 273, 37, 37);
  add("deep_masseter", 82, 140, 16, 35);
  add("anterior_temporalis", 158, 308, 35, 35);
  add("middle_temporalis", 96, 96, 30, 30);
  add("posterior_temporalis", 76, 222, 16, 16);
  add("medial_pterygoid", 175, 240, 40, 40);
  add("anterior_digastric", 40, 46, -89, -89);
  add("geniohyoid", 32, 39, -100, -100);
  return jaw;
}

Jaw tabulated_translation_jaw(const std::string& name) {
  Jaw jaw = tabulated_hinge_jaw(name);
  jaw.motion = JawMotion::translation;
  // The table lists no lateral pterygoid: 60 N at 40 degrees to the axis is this simulator's
  // choice.
  const double cosine = elementary::cos(40 * kDegree);
  jaw.muscles = {{.name = "lateral_pterygoid_a", .maximum_force_N = 60, .arm = cosine},
                 {.name = "lateral_pterygoid_b", .maximum_force_N = 60, .arm = -cosine}};
  return jaw;
}

}  // namespace condyle::host
