// SPDX-License-Identifier: Apache-2.0
#include "simulation/subject.h"

#include <algorithm>
#include <cmath>

#include "simulation/integrator.h"

namespace condyle::host {
namespace {

constexpr std::size_t kCoordinate = 0, kRate = 1, kBristle = 2, kFoodHeight = 3;
constexpr double kTick_s = 1e-3;
// Feedback of the muscles' command: natural frequency (rad/s), critically damped.
constexpr double kFollowing_rad_s = 15;
// Factor of the biting force over the food's resistance; above 1, so that the food breaks.
constexpr double kBiteGain = 1.1;
constexpr double kFoodClearance_m = 0.002;

constexpr std::size_t index(Cause cause) {
  return static_cast<std::size_t>(cause);
}

// 1 within a pulse of `width_s` at the start of each period, with linear flanks.
double pulse(double time_s, double period_s, double width_s, double rise_s) {
  const double phase_s = time_s - period_s * std::floor(time_s / period_s);
  return std::clamp(std::min(phase_s, width_s - phase_s) / rise_s, 0.0, 1.0);
}

}  // namespace

const char* cause_name(Cause cause) {
  constexpr const char* names[kCauses] = {"muscle",  "weight", "friction", "support",
                                          "contact", "food",   "load",     "offset"};
  return names[index(cause)];
}

double needed_steps_per_millisecond(const SubjectParameters& p) {
  constexpr double deepest_contact_m = 5e-4, fastest_m_s = 0.3, largest_product = 0.5;
  // The smallest effective mass of the followed point.
  const double R = p.jaw.incisor_radius_m;
  const double mass_kg =
      p.jaw.motion == JawMotion::hinge ? p.jaw.inertia_kg_m2 / (R * R) : p.jaw.mass_kg;
  const FrictionLaw& law = p.friction;
  const double scale = p.friction_scale * std::max(1.0, p.friction_schedule.factor);
  double damping_Ns_m = law.viscous_Ns_m;
  if (law.model == FrictionModel::coulomb)
    damping_Ns_m += law.coulomb_N / law.smoothing_velocity_m_s;
  if (law.model == FrictionModel::stribeck)
    damping_Ns_m += law.static_N / law.smoothing_velocity_m_s;
  if (law.model == FrictionModel::lugre) damping_Ns_m += law.bristle_damping_Ns_m;
  double stiffness_N_m = p.support_stiffness_N_m;
  if (p.jaw.motion == JawMotion::hinge) {
    stiffness_N_m += 1.5 * p.contact_stiffness_N_m15 * std::sqrt(deepest_contact_m);
  }
  if (p.food_height_m > 0) stiffness_N_m += p.food_stiffness_N_m;
  double bristle_rate = 0;
  if (law.model == FrictionModel::lugre) {
    stiffness_N_m += scale * law.bristle_stiffness_N_m;
    bristle_rate = law.bristle_stiffness_N_m * fastest_m_s / law.coulomb_N;
  }
  const double rate = std::max({scale * damping_Ns_m / mass_kg, std::sqrt(stiffness_N_m / mass_kg),
                                bristle_rate, 1 / p.food_flow_time_s});
  return std::ceil(rate * kTick_s / largest_product);
}

SimulatedSubject::SimulatedSubject(const SubjectParameters& parameters, std::uint64_t seed)
    : parameters_(parameters),
      step_s_(kTick_s / parameters.steps_per_millisecond),
      generator_(seed),
      reference_(parameters.task, {.normal = [this] { return generator_.normal(); },
                                   .uniform = [this] { return generator_.uniform(); }}),
      next_food_height_m_(parameters.food_height_m) {
  double start_m = parameters.task.rest_position_m;
  if (parameters.drive == SubjectDrive::released) start_m -= parameters.task.amplitude_m;
  x_[kCoordinate] = parameters.jaw.coordinate_at(start_m);
  x_[kFoodHeight] = 0;  // the first piece appears at the first wide opening
  if (parameters.drive == SubjectDrive::muscles) {  // at rest, with the required activation
    command_muscles();
    for (std::size_t n = 0; n < kMostMuscles; ++n) x_[kActivations + n] = excitation_[n];
  }
}

double SimulatedSubject::load_N(double time_s) const {
  if (parameters_.load_force_N == 0) return 0;
  return parameters_.load_force_N * pulse(time_s, parameters_.load_period_s,
                                          parameters_.load_width_s, parameters_.load_rise_s);
}

// Passive forces at the followed point.
double SimulatedSubject::passive_force_N(Cause cause, double time_s, double position_m,
                                         double velocity_m_s, const State& x) const {
  const SubjectParameters& p = parameters_;
  switch (cause) {
    case Cause::friction:
      return -friction_force_N(p.friction, velocity_m_s, x[kBristle],
                               p.friction_scale * p.friction_schedule.factor_at(time_s));
    case Cause::support:
      return -p.support_stiffness_N_m * (position_m - p.support_rest_m);
    case Cause::contact: {
      if (p.jaw.motion == JawMotion::translation || position_m <= 0) return 0;
      const double elastic_N = p.contact_stiffness_N_m15 * position_m * std::sqrt(position_m);
      return -std::max(0.0, elastic_N * (1 + p.contact_damping_s_m * velocity_m_s));
    }
    case Cause::food:
      if (x[kFoodHeight] <= 0) return 0;
      return -p.food_stiffness_N_m * std::max(0.0, x[kFoodHeight] + position_m);
    case Cause::load:
      return load_N(time_s);
    case Cause::offset:
      return p.offset_N;
    default:
      return 0;
  }
}

// The force that moves the point mass along the task's motion.
double SimulatedSubject::compensating_force_N(const MotionPoint& wanted) const {
  const SubjectParameters& p = parameters_;
  const double mass_kg = p.drive_mass_kg > 0 ? p.drive_mass_kg : p.jaw.mass_kg;
  return mass_kg * wanted.acceleration_m_s2 + p.drive_friction_Ns_m * wanted.velocity_m_s +
         p.support_stiffness_N_m * (wanted.position_m - p.support_rest_m) - p.offset_N;
}

SimulatedSubject::Forces SimulatedSubject::forces_at(double time_s, const State& x) {
  const SubjectParameters& p = parameters_;
  const double q = x[kCoordinate], q_rate = x[kRate];
  Forces forces{};
  forces.slope = p.jaw.followed_slope(q);
  forces.position_m = p.jaw.followed_position_m(q);
  forces.velocity_m_s = forces.slope * q_rate;
  for (const Cause cause :
       {Cause::friction, Cause::support, Cause::contact, Cause::food, Cause::load, Cause::offset}) {
    forces.generalised[index(cause)] =
        forces.slope * passive_force_N(cause, time_s, forces.position_m, forces.velocity_m_s, x);
  }
  forces.generalised[index(Cause::weight)] = p.jaw.weight(q);
  double& drive = forces.generalised[index(Cause::muscle)];
  if (is_held_) return forces;
  if (p.drive == SubjectDrive::muscles) {
    for (std::size_t n = 0; n < p.jaw.muscles.size(); ++n) {
      const Muscle& muscle = p.jaw.muscles[n];
      drive += muscle.gain * muscle.arm * x[kActivations + n] * muscle.maximum_force_N *
               force_length_factor(muscle, q) * force_velocity_factor(muscle, q_rate);
    }
  } else if (p.drive == SubjectDrive::force) {
    drive = forces.slope * compensating_force_N(reference_.at(time_s));
  }
  double sum = 0;
  for (const double force : forces.generalised) sum += force;
  forces.q_acceleration = sum / p.jaw.inertia();
  if (p.drive == SubjectDrive::prescribed) {
    // Inverse dynamics: the drive is the required force minus the other forces.
    forces.q_acceleration = reference_.at(time_s).acceleration_m_s2;
    drive = p.jaw.inertia() * forces.q_acceleration - sum;
  }
  return forces;
}

void SimulatedSubject::derivative(double time_s, const State& x, State& rate) {
  const SubjectParameters& p = parameters_;
  State at = x;
  if (p.drive == SubjectDrive::prescribed) {
    const MotionPoint wanted = reference_.at(time_s);
    at[kCoordinate] = wanted.position_m;
    at[kRate] = wanted.velocity_m_s;
  }
  const Forces forces = forces_at(time_s, at);
  rate.fill(0);
  rate[kCoordinate] = at[kRate];
  rate[kRate] = forces.q_acceleration;
  rate[kBristle] = bristle_rate_m_s(p.friction, forces.velocity_m_s, at[kBristle]);
  if (p.food_height_m > 0) {
    const double compressed_m = at[kFoodHeight] + forces.position_m;
    const double excess_m = compressed_m - p.food_strength_N / p.food_stiffness_N_m;
    rate[kFoodHeight] = -std::max(0.0, excess_m) / p.food_flow_time_s;
  }
  for (std::size_t n = 0; n < p.jaw.muscles.size(); ++n) {
    rate[kActivations + n] = activation_rate(at[kActivations + n], excitation_[n]);
  }
  for (std::size_t cause = 0; cause < kCauses; ++cause) {
    if (is_held_) continue;  // the holding hand balances all forces
    rate[kImpulse + cause] = forces.generalised[cause];
    rate[kWork + cause] = forces.generalised[cause] * at[kRate];
  }
}

void SimulatedSubject::command_muscles() {
  const SubjectParameters& p = parameters_;
  const double q = x_[kCoordinate], q_rate = x_[kRate];
  const double J = p.jaw.followed_slope(q);
  const double z = p.jaw.followed_position_m(q), v = J * q_rate;
  const MotionPoint wanted = reference_.at(time_s());
  const double acceleration_m_s2 = wanted.acceleration_m_s2 +
                                   kFollowing_rad_s * kFollowing_rad_s * (wanted.position_m - z) +
                                   2 * kFollowing_rad_s * (wanted.velocity_m_s - v);
  double wanted_drive = p.jaw.effective_mass_kg(q) * J * acceleration_m_s2;
  // The subject compensates the felt forces, and while closing also more than the food's; friction
  // and load are unexpected.
  wanted_drive -= p.jaw.weight(q);
  wanted_drive -= J * (passive_force_N(Cause::support, time_s(), z, v, x_) + p.offset_N);
  if (wanted.velocity_m_s > 0) {
    wanted_drive -= J * kBiteGain * passive_force_N(Cause::food, time_s(), z, v, x_);
  }
  if (p.clench_force_N > 0) {
    wanted_drive += J * p.clench_force_N * pulse(time_s(), 2, 1, 0.2);
  }
  double available = 0;
  for (const Muscle& muscle : p.jaw.muscles) {
    if (muscle.arm * wanted_drive <= 0) continue;
    available += std::abs(muscle.gain * muscle.arm) * muscle.maximum_force_N *
                 force_length_factor(muscle, q) * force_velocity_factor(muscle, q_rate);
  }
  const double share = available > 0 ? std::clamp(std::abs(wanted_drive) / available, 0.0, 1.0) : 0;
  for (std::size_t n = 0; n < p.jaw.muscles.size(); ++n) {
    excitation_[n] = p.jaw.muscles[n].arm * wanted_drive > 0 ? share : 0;
  }
}

void SimulatedSubject::renew_food() {
  const double z = parameters_.jaw.followed_position_m(x_[kCoordinate]);
  const bool is_broken = x_[kFoodHeight] < next_food_height_m_ || x_[kFoodHeight] <= 0;
  if (!is_broken || -z < next_food_height_m_ + kFoodClearance_m) return;
  x_[kFoodHeight] = next_food_height_m_;
  next_food_height_m_ *= 1 - parameters_.food_softening;
}

void SimulatedSubject::step() {
  if (steps_ % static_cast<std::uint64_t>(parameters_.steps_per_millisecond) == 0) {
    if (parameters_.drive == SubjectDrive::muscles) command_muscles();
    if (parameters_.food_height_m > 0) renew_food();
  }
  is_held_ = parameters_.drive == SubjectDrive::released && time_s() < parameters_.release_s;
  runge_kutta_4_step(x_, time_s(), step_s_,
                     [this](double t, const State& x, State& rate) { derivative(t, x, rate); });
  ++steps_;
  if (parameters_.drive == SubjectDrive::prescribed) {
    const MotionPoint wanted = reference_.at(time_s());
    x_[kCoordinate] = wanted.position_m;
    x_[kRate] = wanted.velocity_m_s;
  }
}

SubjectTruth SimulatedSubject::truth() {
  const SubjectParameters& p = parameters_;
  const Forces forces = forces_at(time_s(), x_);
  SubjectTruth truth;
  truth.time_s = time_s();
  truth.coordinate = x_[kCoordinate];
  truth.coordinate_rate = x_[kRate];
  truth.position_m = forces.position_m;
  truth.velocity_m_s = forces.velocity_m_s;
  truth.acceleration_m_s2 =
      forces.slope * forces.q_acceleration +
      p.jaw.followed_curvature(truth.coordinate) * truth.coordinate_rate * truth.coordinate_rate;
  for (std::size_t cause = 0; cause < kCauses; ++cause) {
    truth.force_N[cause] = forces.generalised[cause] / forces.slope;
    truth.work_J[cause] = x_[kWork + cause];
    truth.impulse[cause] = x_[kImpulse + cause];
  }
  for (std::size_t n = 0; n < kMostMuscles; ++n) {
    truth.activation[n] = x_[kActivations + n];
    truth.excitation[n] = excitation_[n];
  }
  truth.momentum = p.jaw.inertia() * truth.coordinate_rate;
  truth.kinetic_energy_J = truth.momentum * truth.coordinate_rate / 2;
  truth.bristle_m = x_[kBristle];
  truth.food_height_m = x_[kFoodHeight];
  truth.effective_mass_kg = p.jaw.effective_mass_kg(truth.coordinate);
  truth.effective_friction_Ns_m =
      friction_slope_Ns_m(p.friction, truth.velocity_m_s, truth.bristle_m,
                          p.friction_scale * p.friction_schedule.factor_at(truth.time_s));
  return truth;
}

}  // namespace condyle::host
