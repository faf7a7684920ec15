// SPDX-License-Identifier: Apache-2.0
// A simulated subject with known truth: a jaw (jaw.h) driven by muscles, by a known force, or along
// a prescribed motion, with friction, support, weight, tooth contact, food and an external load.
//
// All forces but the muscles' moments and the weight act at the followed point along the followed
// axis z (up, closing). Closed teeth are at z = 0.
//   friction  -factor(t) x friction model (friction.h) at z'
//   support   -ks (z - z_rest)
//   contact   -k_c p^1.5 (1 + d z'), p = z > 0, never pulling (Hunt and Crossley, J. Appl. Mech. 42
//             (1975) 440-445)
//   food      -k_b c, c = h + z > 0 compressed; what exceeds F_b breaks it:
//             h' = -(k_b c - F_b) / (k_b tau); a new piece, softer, with each wide opening
//   load      a known force on the chin, in trapezoidal pulses
//   offset    a constant force
// Integrated with classical Runge-Kutta steps, a whole number in each millisecond; muscles are
// commanded once a millisecond by inverse dynamics with feedback, shared equally among agonists.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "simulation/friction.h"
#include "simulation/jaw.h"
#include "simulation/reference_motion.h"
#include "statistics/random.h"

namespace condyle::host {

/// What moves the jaw.
enum class SubjectDrive {
  muscles,     ///< commanded to follow the task
  force,       ///< would follow the task if friction were `drive_friction_Ns_m`
  prescribed,  ///< the task itself; the force follows by inverse dynamics
  released,    ///< held at the amplitude until `release_s`, then free
};

/// Parameters of a subject.
struct SubjectParameters {
  SubjectDrive drive = SubjectDrive::muscles;
  Jaw jaw;
  MotionTask task;
  FrictionLaw friction;
  FrictionSchedule friction_schedule;
  double friction_scale = 1;  ///< multiplies the schedule
  double drive_mass_kg = 0;   ///< mass for computing the driving force (force); 0: the jaw's
  double drive_friction_Ns_m = 0.022;
  double support_stiffness_N_m = 20;
  double support_rest_m = -0.002;
  double offset_N = 0;
  double contact_stiffness_N_m15 = 1e7;  ///< k_c (N/m^1.5)
  double contact_damping_s_m = 5;        ///< d (s/m)
  double food_height_m = 0;              ///< 0: none
  double food_stiffness_N_m = 3500;
  double food_strength_N = 35;
  double food_flow_time_s = 0.01;  ///< tau
  double food_softening = 0.05;    ///< share of its predecessor's height that each piece loses
  double clench_force_N = 0;       ///< bite force in pulses of a second, every two
  double load_force_N = 0;         ///< external load in pulses
  double load_period_s = 2;
  double load_width_s = 0.5;
  double load_rise_s = 0.02;
  double release_s = 0.2;
  int steps_per_millisecond = 10;
};

/// The causes of force.
enum class Cause { muscle, weight, friction, support, contact, food, load, offset };
/// Number of causes.
inline constexpr std::size_t kCauses = 8;
/// Name of a cause in column names.
const char* cause_name(Cause cause);
using condyle::kMostMuscles;

/// The true state of a subject at one instant.
struct SubjectTruth {
  double time_s = 0;
  double position_m = 0, velocity_m_s = 0, acceleration_m_s2 = 0;  ///< followed coordinate
  double coordinate = 0, coordinate_rate = 0;                      ///< q, q' (rad or m)
  std::array<double, kCauses> force_N{};                           ///< along the followed axis
  std::array<double, kCauses> work_J{};                            ///< done since the start
  std::array<double, kCauses> impulse{};  ///< generalised: Nms of a hinge, Ns of a translation
  std::array<double, kMostMuscles> activation{};
  std::array<double, kMostMuscles> excitation{};
  double kinetic_energy_J = 0;
  double momentum = 0;  ///< inertia x q'
  double food_height_m = 0;
  double bristle_m = 0;                ///< LuGre deflection
  double effective_mass_kg = 0;        ///< at the followed coordinate
  double effective_friction_Ns_m = 0;  ///< local slope of friction against velocity
  /// Active force along the followed axis, as a complete force sensor would measure it: muscles and
  /// load.
  double drive_N() const {
    return force_N[static_cast<std::size_t>(Cause::muscle)] +
           force_N[static_cast<std::size_t>(Cause::load)];
  }
};

/// Steps per millisecond for a converged integration: the fastest rate of the subject's forces
/// (friction at rest and at 0.3 m/s, contact, food, support) times the step is at most 0.5.
double needed_steps_per_millisecond(const SubjectParameters& parameters);

/// A subject in motion.
class SimulatedSubject {
 public:
  /// The task's random numbers come from `seed`.
  SimulatedSubject(const SubjectParameters& parameters, std::uint64_t seed);
  SimulatedSubject(const SimulatedSubject&) = delete;
  SimulatedSubject& operator=(const SimulatedSubject&) = delete;

  /// Advances by one integration step.
  void step();
  double time_s() const { return static_cast<double>(steps_) * step_s_; }
  double step_s() const { return step_s_; }
  /// The present state.
  SubjectTruth truth();

 private:
  // State x: q, q', bristle deflection, food height, activations, work and impulse by cause.
  static constexpr std::size_t kActivations = 4;
  static constexpr std::size_t kWork = kActivations + kMostMuscles;
  static constexpr std::size_t kImpulse = kWork + kCauses;
  static constexpr std::size_t kStates = kImpulse + kCauses;
  using State = std::array<double, kStates>;

  struct Forces {
    double position_m, velocity_m_s, slope;   // of the followed coordinate; dz/dq
    std::array<double, kCauses> generalised;  // by cause
    double q_acceleration;
  };
  Forces forces_at(double time_s, const State& x);
  void derivative(double time_s, const State& x, State& rate);
  double passive_force_N(Cause cause, double time_s, double position_m, double velocity_m_s,
                         const State& x) const;
  double load_N(double time_s) const;
  void command_muscles();
  void renew_food();
  double compensating_force_N(const MotionPoint& wanted) const;

  SubjectParameters parameters_;
  double step_s_;
  RandomGenerator generator_;
  ReferenceMotion reference_;
  State x_{};
  std::array<double, kMostMuscles> excitation_{};
  double next_food_height_m_;
  bool is_held_ = false;  // during the present step
  std::uint64_t steps_ = 0;
};

}  // namespace condyle::host
