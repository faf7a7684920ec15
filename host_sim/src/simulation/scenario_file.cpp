// SPDX-License-Identifier: Apache-2.0
#include "simulation/scenario_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "condyle/estimator/math/elementary.h"
#include "hosted/files/input_error.h"
#include "hosted/files/toml_reader.h"
#include "simulation/facebow_section.h"

namespace condyle::host {
namespace {

constexpr Range kNonNegative{0, 1e9};
constexpr Range kShare{0, 1};
constexpr Range kPlace_m{-0.1, 0.1};

// The jaw: one of the tabulated subjects, with the changes of the file.
void read_subject(TomlReader& file, Scenario& scenario) {
  SubjectParameters& subject = scenario.subject;
  std::size_t motion = 0;
  file.choice("subject", "motion", motion, {"hinge", "lateral", "protrusive", "point_mass"});
  std::size_t drive = motion == 3 ? 1 : 0;
  file.choice("subject", "drive", drive, {"muscles", "force", "prescribed", "released"});
  subject.drive = static_cast<SubjectDrive>(drive);
  std::size_t table = 0;
  const std::vector<std::string_view> tables = {"artisynth", "anybody"};
  file.choice("subject", "jaw", table, tables);
  const std::string name(tables[table]);
  constexpr Axis axes[] = {Axis::z, Axis::x, Axis::y, Axis::z};
  scenario.axis = axes[motion];
  subject.jaw = motion == 0 ? tabulated_hinge_jaw(name) : tabulated_translation_jaw(name);
  const bool is_point_mass = motion == 3;
  if (is_point_mass) {
    subject.jaw.muscles.clear();
    subject.jaw.mass_kg = 0.25;
  }
  const bool needs_muscles = subject.drive == SubjectDrive::muscles;
  const bool needs_mass =
      subject.drive == SubjectDrive::force || subject.drive == SubjectDrive::prescribed;
  if ((needs_muscles && is_point_mass) || (needs_mass && motion == 0)) {
    throw InputError(
        file.place("subject", "drive"), "this drive does not match this motion",
        "muscles drive a hinge, lateral or protrusive jaw; force and prescribed drive a "
        "point_mass, lateral or protrusive one");
  }
  Jaw& jaw = subject.jaw;
  file.number("subject", "mass_kg", jaw.mass_kg, "kg", {1e-3, 10});
  file.number("subject", "inertia_kg_m2", jaw.inertia_kg_m2, "kg m^2", {1e-6, 1});
  file.number("subject", "incisor_radius_m", jaw.incisor_radius_m, "m", {0.01, 0.5});
  file.number("subject", "incisor_angle_rad", jaw.incisor_angle_rad, "rad", {-1, 1});
  file.number("subject", "centre_of_mass_radius_m", jaw.centre_of_mass_radius_m, "m", {0, 0.5});
  for (Muscle& muscle : jaw.muscles) {
    const std::string section = "muscle_" + muscle.name;
    file.number(section, "maximum_force_N", muscle.maximum_force_N, "N", {0, 1e4});
    file.number(section, "arm", muscle.arm, "m, or the cosine of its angle", {-1, 1});
    file.number(section, "optimal_length_m", muscle.optimal_length_m, "m", {1e-3, 1});
    file.number(section, "gain", muscle.gain, "1", {0, 100});
  }
  file.number("subject", "support_stiffness_N_m", subject.support_stiffness_N_m, "N/m", {0, 1e5});
  file.number("subject", "support_rest_m", subject.support_rest_m, "m", kPlace_m);
  file.number("subject", "offset_N", subject.offset_N, "N", {-1e3, 1e3});
  file.number("subject", "drive_friction_Ns_m", subject.drive_friction_Ns_m, "Ns/m", {0, 1e4});
  file.number("subject", "release_s", subject.release_s, "s", {0, 1e4});
}

// The integration step: as small as the forces require, or smaller if the file requests it.
void read_steps(TomlReader& file, SubjectParameters& subject) {
  constexpr double most = 1000;
  const double needed = needed_steps_per_millisecond(subject);
  double steps = std::max(needed, 10.0);
  file.number("subject", "steps_per_millisecond", steps, "whole number", {1, most});
  if (steps != std::floor(steps)) {
    throw InputError(file.place("subject", "steps_per_millisecond"), "is not a whole number",
                     "give 1 to 1000");
  }
  if (steps < needed || needed > most) {
    throw InputError(
        file.place("subject", "steps_per_millisecond"),
        fmt::format("the forces are so stiff that a millisecond requires {} steps", needed),
        needed > most ? "make friction, contact, food or support less stiff"
                      : "give at least this number, or leave it out");
  }
  subject.steps_per_millisecond = static_cast<int>(steps);
}

// The lowest point of the incisor's circle limits the opening of a hinge.
void check_reach(const TomlReader& file, const SubjectParameters& subject) {
  const MotionTask& task = subject.task;
  const double far_m = task.amplitude_m * (1 + 3 * task.amplitude_spread) + 3 * task.tremor_m;
  const double lowest_m = task.rest_position_m - far_m;
  const Jaw& jaw = subject.jaw;
  if (jaw.motion == JawMotion::translation) return;
  constexpr double steepest_sine = -0.95, most_closed_m = 0.002;
  const double reach_m =
      jaw.incisor_radius_m * (steepest_sine - elementary::sin(jaw.incisor_angle_rad));
  if (lowest_m >= reach_m && task.rest_position_m <= most_closed_m) return;
  throw InputError(
      file.place("task", lowest_m < reach_m ? "amplitude_m" : "rest_position_m"),
      fmt::format("the task reaches {:.1f} mm, but this jaw moves from {:.1f} to {:.1f} mm",
                  (lowest_m < reach_m ? lowest_m : task.rest_position_m) * 1e3, reach_m * 1e3,
                  most_closed_m * 1e3),
      "reduce rest_position_m, amplitude_m or amplitude_spread (3 times it counts)");
}

void read_task(TomlReader& file, MotionTask& task) {
  file.number("task", "rest_position_m", task.rest_position_m, "m", kPlace_m);
  file.number("task", "amplitude_m", task.amplitude_m, "m", {0, 0.06});
  file.number("task", "amplitude_spread", task.amplitude_spread, "share", kShare);
  file.number("task", "cycle_rate_Hz", task.cycle_rate_Hz, "Hz", {0.01, 20});
  file.number("task", "rate_spread", task.rate_spread, "share", kShare);
  file.number("task", "dwell_share", task.dwell_share, "share", {0, 0.9});
  file.number("task", "pause_probability", task.pause_probability, "share", kShare);
  file.number("task", "pause_s", task.pause_s, "s", {0, 3600});
  file.number("task", "tremor_m", task.tremor_m, "m", {0, 0.01});
  file.number("task", "tremor_Hz", task.tremor_Hz, "Hz", {0.1, 50});
  std::size_t alternates = task.alternates ? 1 : 0;
  file.choice("task", "sides", alternates, {"one", "alternating"});
  task.alternates = alternates == 1;
}

void read_forces(TomlReader& file, SubjectParameters& subject) {
  FrictionLaw& friction = subject.friction;
  friction.viscous_Ns_m = 0.022;
  std::size_t model = 0;
  file.choice("friction", "model", model, {"viscous", "coulomb", "stribeck", "lugre"});
  friction.model = static_cast<FrictionModel>(model);
  file.number("friction", "viscous_Ns_m", friction.viscous_Ns_m, "Ns/m", {0, 1e4});
  file.number("friction", "coulomb_N", friction.coulomb_N, "N", {1e-6, 1e3});
  file.number("friction", "static_N", friction.static_N, "N", {1e-6, 1e3});
  file.number("friction", "stribeck_velocity_m_s", friction.stribeck_velocity_m_s, "m/s",
              {1e-6, 10});
  file.number("friction", "smoothing_velocity_m_s", friction.smoothing_velocity_m_s, "m/s",
              {1e-6, 10});
  file.number("friction", "bristle_stiffness_N_m", friction.bristle_stiffness_N_m, "N/m", {1, 1e6});
  file.number("friction", "bristle_damping_Ns_m", friction.bristle_damping_Ns_m, "Ns/m", {0, 1e4});
  const bool breaks_away =
      friction.model == FrictionModel::stribeck || friction.model == FrictionModel::lugre;
  if (breaks_away && friction.static_N < friction.coulomb_N) {
    throw InputError(file.place("friction", "static_N"), "static_N is below coulomb_N",
                     "give static_N of at least coulomb_N");
  }
  FrictionSchedule& schedule = subject.friction_schedule;
  std::size_t shape = 0;
  file.choice("friction", "change", shape, {"constant", "step", "ramp"});
  schedule.shape = static_cast<FrictionSchedule::Shape>(shape);
  file.number("friction", "change_start_s", schedule.start_s, "s", kNonNegative);
  schedule.end_s = schedule.start_s + 1;
  file.number("friction", "change_end_s", schedule.end_s, "s", kNonNegative);
  file.number("friction", "change_factor", schedule.factor, "1", {0, 1e6});
  if (schedule.shape == FrictionSchedule::Shape::ramp && schedule.end_s <= schedule.start_s) {
    throw InputError(file.place("friction", "change_end_s"), "the ramp ends before it starts",
                     "give change_start_s < change_end_s");
  }
  file.number("contact", "stiffness_N_m15", subject.contact_stiffness_N_m15, "N/m^1.5",
              kNonNegative);
  file.number("contact", "damping_s_m", subject.contact_damping_s_m, "s/m", {0, 1e3});
  file.number("contact", "clench_force_N", subject.clench_force_N, "N", {0, 1e3});
  file.number("food", "height_m", subject.food_height_m, "m", {0, 0.05});
  file.number("food", "stiffness_N_m", subject.food_stiffness_N_m, "N/m", {1, 1e6});
  file.number("food", "strength_N", subject.food_strength_N, "N", {0, 1e3});
  file.number("food", "flow_time_s", subject.food_flow_time_s, "s", {1e-3, 10});
  file.number("food", "softening", subject.food_softening, "share", {0, 0.9});
  file.number("load", "force_N", subject.load_force_N, "N", {-1e3, 1e3});
  file.number("load", "period_s", subject.load_period_s, "s", {1e-2, 1e4});
  file.number("load", "width_s", subject.load_width_s, "s", {1e-3, 1e4});
  file.number("load", "rise_s", subject.load_rise_s, "s", {1e-3, 1e3});
}

void read_instruments(TomlReader& file, Scenario& scenario) {
  read_facebow(file, scenario.facebow);
  std::size_t gives = 0;
  file.choice("facebow", "gives", gives, {"points", "axis"});
  scenario.facebow.gives_points = gives == 0;

  file.number("drive", "rate_Hz", scenario.drive.rate_Hz, "Hz", {0, 5000});
  file.number("drive", "noise_N", scenario.drive.noise_N, "N", {0, 1e3});
  file.number("drive", "gain", scenario.drive.gain, "1", {-10, 10});
  file.number("drive", "missing_share", scenario.drive.missing_share, "share", kShare);
  file.number("drive", "missing_in_phase_Ns_m", scenario.drive.missing_in_phase_Ns_m, "Ns/m",
              {-100, 100});
  file.number("drive", "delay_s", scenario.drive.delay_s, "s", {0, 1});
  file.number("emg", "rate_Hz", scenario.emg.rate_Hz, "Hz", {0, 5000});
  file.number("emg", "noise", scenario.emg.noise, "share of the maximum", {0, 10});
  file.number("emg", "gain", scenario.emg.gain, "1", {0, 100});
  file.number("emg", "missing_share", scenario.emg.missing_share, "share", kShare);
  file.number("emg", "delay_s", scenario.emg.delay_s, "s", {0, 1});
  file.number("head", "rate_Hz", scenario.head.rate_Hz, "Hz", {0, 5000});
  file.number("head", "noise_m_s2", scenario.head.noise_m_s2, "m/s^2", {0, 100});
  file.number("head", "gain", scenario.head.gain, "1", {-10, 10});
  file.number("head", "delay_s", scenario.head.delay_s, "s", {0, 1});
  const bool is_driven_point =
      scenario.subject.drive == SubjectDrive::force && scenario.subject.jaw.muscles.empty();
  if (scenario.head.rate_Hz > 0 && !is_driven_point) {
    throw InputError(file.place("head", "rate_Hz"),
                     "the head's acceleration drives a point_mass only",
                     "write motion = \"point_mass\" and drive = \"force\" in [subject]");
  }
}

}  // namespace

Scenario load_scenario(const std::string& path) {
  TomlReader file(path);
  if (file.has("", "kinematic")) {
    throw InputError(file.place("", "kinematic"),
                     "a kinematic jaw moves without forces, which this command needs",
                     "give it to condyle simulate, or as sim:SCENARIO to condyle replay");
  }
  Scenario scenario;
  scenario.name = std::filesystem::path(path).stem().string();
  file.number("", "duration_s", scenario.duration_s, "s", {0.1, 86400});
  double seed = 1;
  file.number("", "seed", seed, "whole number", {0, 9e15});
  if (seed != std::floor(seed)) {
    throw InputError(file.place("", "seed"), "is not a whole number", "give 0 to 9e15");
  }
  scenario.seed = static_cast<std::uint64_t>(seed);
  read_subject(file, scenario);
  read_task(file, scenario.subject.task);
  read_forces(file, scenario.subject);
  read_instruments(file, scenario);
  read_steps(file, scenario.subject);
  check_reach(file, scenario.subject);
  file.finish();
  return scenario;
}

}  // namespace condyle::host
