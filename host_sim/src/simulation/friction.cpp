// SPDX-License-Identifier: Apache-2.0
#include "simulation/friction.h"

#include <cmath>

#include "condyle/estimator/math/elementary.h"

namespace condyle::host {

namespace {

// A function of the velocity and its derivative.
struct Curve {
  double value, slope;
};

// g(v).
Curve stribeck_level(const FrictionLaw& p, double v) {
  const double ratio = v / p.stribeck_velocity_m_s;
  const double excess_N = (p.static_N - p.coulomb_N) * elementary::exp(-ratio * ratio);
  return {p.coulomb_N + excess_N, -2 * ratio / p.stribeck_velocity_m_s * excess_N};
}

Curve smooth_sign(const FrictionLaw& p, double v) {
  const double sign = elementary::tanh(v / p.smoothing_velocity_m_s);
  return {sign, (1 - sign * sign) / p.smoothing_velocity_m_s};
}

double sign(double v) {
  return v > 0 ? 1 : v < 0 ? -1 : 0;
}

// z' and its derivative to v at fixed z.
Curve bristle_rate(const FrictionLaw& p, double v, double z) {
  const Curve g = stribeck_level(p, v);
  const double pull = p.bristle_stiffness_N_m * z / g.value;
  return {v - std::abs(v) * pull, 1 - sign(v) * pull + std::abs(v) * pull * g.slope / g.value};
}

// F at scale 1 and its derivative to v at fixed z.
Curve friction(const FrictionLaw& p, double v, double z) {
  Curve dry = {0, 0};
  switch (p.model) {
    case FrictionModel::viscous:
      break;
    case FrictionModel::coulomb: {
      const Curve s = smooth_sign(p, v);
      dry = {p.coulomb_N * s.value, p.coulomb_N * s.slope};
      break;
    }
    case FrictionModel::stribeck: {
      const Curve s = smooth_sign(p, v), g = stribeck_level(p, v);
      dry = {g.value * s.value, g.slope * s.value + g.value * s.slope};
      break;
    }
    case FrictionModel::lugre: {
      const Curve rate = bristle_rate(p, v, z);
      dry = {p.bristle_stiffness_N_m * z + p.bristle_damping_Ns_m * rate.value,
             p.bristle_damping_Ns_m * rate.slope};
      break;
    }
  }
  return {dry.value + p.viscous_Ns_m * v, dry.slope + p.viscous_Ns_m};
}

// F of steady sliding at scale 1.
Curve steady_friction(const FrictionLaw& p, double v) {
  if (p.model != FrictionModel::lugre) return friction(p, v, 0);
  const Curve g = stribeck_level(p, v);
  return {sign(v) * g.value + p.viscous_Ns_m * v, sign(v) * g.slope + p.viscous_Ns_m};
}

}  // namespace

double bristle_rate_m_s(const FrictionLaw& parameters, double velocity_m_s, double deflection_m) {
  if (parameters.model != FrictionModel::lugre) return 0;
  return bristle_rate(parameters, velocity_m_s, deflection_m).value;
}

double friction_force_N(const FrictionLaw& parameters, double velocity_m_s, double deflection_m,
                        double scale) {
  return scale * friction(parameters, velocity_m_s, deflection_m).value;
}

double friction_slope_Ns_m(const FrictionLaw& parameters, double velocity_m_s, double deflection_m,
                           double scale) {
  return scale * friction(parameters, velocity_m_s, deflection_m).slope;
}

double steady_deflection_m(const FrictionLaw& parameters, double velocity_m_s) {
  if (parameters.model != FrictionModel::lugre) return 0;
  return sign(velocity_m_s) * stribeck_level(parameters, velocity_m_s).value /
         parameters.bristle_stiffness_N_m;
}

double steady_friction_N(const FrictionLaw& parameters, double velocity_m_s, double scale) {
  return scale * steady_friction(parameters, velocity_m_s).value;
}

double steady_friction_slope_Ns_m(const FrictionLaw& parameters, double velocity_m_s,
                                  double scale) {
  return scale * steady_friction(parameters, velocity_m_s).slope;
}

double dissipated_power_W(const FrictionLaw& parameters, double velocity_m_s, double deflection_m,
                          double scale) {
  const double taken_W =
      friction_force_N(parameters, velocity_m_s, deflection_m, scale) * velocity_m_s;
  const double stored_W = scale * parameters.bristle_stiffness_N_m * deflection_m *
                          bristle_rate_m_s(parameters, velocity_m_s, deflection_m);
  return taken_W - stored_W;
}

double bristle_energy_J(const FrictionLaw& parameters, double deflection_m, double scale) {
  if (parameters.model != FrictionModel::lugre) return 0;
  return scale * parameters.bristle_stiffness_N_m * deflection_m * deflection_m / 2;
}

double FrictionSchedule::factor_at(double time_s) const {
  switch (shape) {
    case Shape::constant:
      return factor;
    case Shape::step:
      return time_s < start_s ? 1 : factor;
    case Shape::ramp:
      if (time_s <= start_s) return 1;
      if (time_s >= end_s) return factor;
      return 1 + (factor - 1) * (time_s - start_s) / (end_s - start_s);
  }
  return factor;
}

}  // namespace condyle::host
