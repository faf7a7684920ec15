// SPDX-License-Identifier: Apache-2.0
// Friction of the simulated joint: the truth that estimates are compared with.
//
//   v        velocity (m/s)
//   z, z'    mean deflection of the bristles (m) and its rate (m/s); only LuGre has bristles
//   F        friction force (N), positive with v: subtract it from the drive, m v' = u - F
//   c        scale: friction as a multiple of the parameters', without unit
//   Fc, Fs   sliding and break-away force (N)
//   vs, vd   Stribeck velocity, velocity over which the sign is smoothed (m/s)
//   s0, s1   stiffness (N/m) and damping (Ns/m) of the bristles
//   s2       viscous friction (Ns/m), part of every model
//   g(v)     Stribeck level, Fc + (Fs - Fc) exp(-(v/vs)^2)
//
//   viscous    F = c s2 v
//   coulomb    F = c (Fc tanh(v/vd) + s2 v)
//   stribeck   F = c (g(v) tanh(v/vd) + s2 v)
//   lugre      F = c (s0 z + s1 z' + s2 v),  z' = v - s0 |v| z / g(v)
//
// R. Stribeck, "Die wesentlichen Eigenschaften der Gleit- und Rollenlager", Z. VDI 46 (1902).
// C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, "A new model for control of systems
// with friction", IEEE Trans. Automatic Control 40(3) (1995) 419-425.
//
// For integration: coulomb and stribeck creep at rest instead of sticking, and relax at up to c
// Fs/(m vd); bristles relax at s0 |v|/g(v), 1e4 per second at 0.1 m/s with the defaults, so a step
// of Runge-Kutta 4 must stay below 2.78 g/(s0 |v|). LuGre with constant s1 stores at most the
// energy that it received, but can return energy briefly if s1 > 4 g(v)/|v|; see
// `dissipated_power_W`. A scale that changes in time also scales the bristles' stored energy (about
// 1e-5 J with the defaults).
#pragma once

#include <cstdint>

namespace condyle::host {

/// Law of friction, see the head of this file.
enum class FrictionModel : std::uint8_t { viscous, coulomb, stribeck, lugre };

/// Parameters of all models; each uses those in its equation. The defaults are the demonstration
/// set of Canudas de Wit et al.
struct FrictionLaw {
  FrictionModel model = FrictionModel::viscous;
  double viscous_Ns_m = 0.4;             ///< s2, force per velocity (Ns/m), >= 0
  double coulomb_N = 1;                  ///< Fc, force of steady sliding (N), > 0 for lugre
  double static_N = 1.5;                 ///< Fs, force that breaks away (N), >= coulomb_N
  double stribeck_velocity_m_s = 1e-3;   ///< vs, where Fs has fallen towards Fc by 1/e (m/s), > 0
  double smoothing_velocity_m_s = 1e-4;  ///< vd, smooths the sign of v (m/s), > 0
  double bristle_stiffness_N_m = 1e5;    ///< s0 (N/m), > 0
  double bristle_damping_Ns_m = 316;     ///< s1 (Ns/m), >= 0
};

/// Rate of the bristle deflection z' (m/s); 0 for models without bristles.
double bristle_rate_m_s(const FrictionLaw& parameters, double velocity_m_s, double deflection_m);

/// Friction force F (N), positive with the velocity. `deflection_m` matters to lugre only.
double friction_force_N(const FrictionLaw& parameters, double velocity_m_s, double deflection_m,
                        double scale = 1);

/// dF/dv at fixed deflection (Ns/m): the effective friction at the followed point. LuGre: s1 + s2
/// when stuck, about s2 in steady sliding well above vs.
double friction_slope_Ns_m(const FrictionLaw& parameters, double velocity_m_s, double deflection_m,
                           double scale = 1);

/// Bristle deflection of steady sliding (m): g(v) sign(v) / s0; 0 for models without bristles.
double steady_deflection_m(const FrictionLaw& parameters, double velocity_m_s);

/// F of steady sliding (N); differs from `friction_force_N` only for lugre.
double steady_friction_N(const FrictionLaw& parameters, double velocity_m_s, double scale = 1);

/// Slope of the curve `steady_friction_N` (Ns/m), negative in the Stribeck dip.
double steady_friction_slope_Ns_m(const FrictionLaw& parameters, double velocity_m_s,
                                  double scale = 1);

/// Power turned into heat (W): F v less the growth of `bristle_energy_J` at constant scale.
double dissipated_power_W(const FrictionLaw& parameters, double velocity_m_s, double deflection_m,
                          double scale = 1);

/// Energy stored in the bristles (J), c s0 z^2 / 2; 0 for models without bristles.
double bristle_energy_J(const FrictionLaw& parameters, double deflection_m, double scale = 1);

/// Friction over time, as the `scale` of the functions above.
struct FrictionSchedule {
  enum class Shape : std::uint8_t {
    constant,  ///< `factor` at all times
    step,      ///< 1 before `start_s`, `factor` from then on
    ramp,      ///< 1 until `start_s`, `factor` from `end_s` on, a straight line between
  };
  Shape shape = Shape::constant;
  double start_s = 0;  ///< step and ramp: where the change begins (s)
  double end_s = 0;    ///< ramp: first instant of `factor` (s), > start_s
  double factor = 1;   ///< without unit, >= 0

  /// The scale at `time_s`.
  double factor_at(double time_s) const;
};

}  // namespace condyle::host
