// SPDX-License-Identifier: Apache-2.0
#include "simulation/jaw.h"

#include <algorithm>
#include <cmath>

#include "condyle/estimator/elementary.h"

namespace condyle::host {
namespace {

constexpr double kGravity_m_s2 = 9.80665;
constexpr double kForceLengthWidth = 0.45;
constexpr double kHillShape = 0.25;
constexpr double kLengtheningPlateau = 1.4;
constexpr double kMaximumLengthsPerSecond = 10;
constexpr double kActivationTime_s = 0.010;
constexpr double kDeactivationTime_s = 0.040;
constexpr double kDegree = 0.017453292519943295;

}  // namespace

double Jaw::followed_position_m(double q) const {
  if (motion == JawMotion::translation) return q;
  return incisor_radius_m *
         (elementary::sin(incisor_angle_rad - q) - elementary::sin(incisor_angle_rad));
}

double Jaw::followed_slope(double q) const {
  return motion == JawMotion::translation
             ? 1
             : -incisor_radius_m * elementary::cos(incisor_angle_rad - q);
}

double Jaw::followed_curvature(double q) const {
  return motion == JawMotion::translation
             ? 0
             : -incisor_radius_m * elementary::sin(incisor_angle_rad - q);
}

double Jaw::coordinate_at(double position_m) const {
  if (motion == JawMotion::translation) return position_m;
  double q = -position_m / incisor_radius_m;
  for (int i = 0; i < 20; ++i) q -= (followed_position_m(q) - position_m) / followed_slope(q);
  return q;
}

double Jaw::weight(double q) const {
  if (motion == JawMotion::translation) return 0;  // these axes are horizontal
  // The height of the centre of mass falls as the jaw opens.
  return mass_kg * kGravity_m_s2 * centre_of_mass_radius_m * elementary::cos(incisor_angle_rad - q);
}

double force_length_factor(const Muscle& muscle, double q) {
  const double stretch = -muscle.arm * q / muscle.optimal_length_m / kForceLengthWidth;
  return elementary::exp(-stretch * stretch);
}

double force_velocity_factor(const Muscle& muscle, double q_rate) {
  const double w = -muscle.arm * q_rate / muscle.optimal_length_m / kMaximumLengthsPerSecond;
  if (w <= -1) return 0;
  if (w <= 0) return (1 + w) / (1 - w / kHillShape);
  // Same slope at w = 0: 1 + 1/shape.
  const double slope = 1 + 1 / kHillShape;
  const double rise = kLengtheningPlateau - 1;
  return 1 + rise * slope * w / (rise + slope * w);
}

double activation_rate(double activation, double excitation) {
  const double gap = excitation - activation;
  return gap / (gap > 0 ? kActivationTime_s : kDeactivationTime_s);
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
