// SPDX-License-Identifier: Apache-2.0
#include "simulation/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"

namespace condyle::host {

SubjectTruth interpolate(const Jaw& jaw, const SubjectTruth& before, const SubjectTruth& after,
                         double time_s) {
  const double step_s = after.time_s - before.time_s;
  const double s = step_s > 0 ? (time_s - before.time_s) / step_s : 1;
  SubjectTruth truth = after;
  truth.time_s = time_s;
  const auto line = [s](double a, double b) { return a + s * (b - a); };
  // Cubic interpolation of both coordinates and rates.
  const double a = before.coordinate, b = after.coordinate;
  const double ra = before.coordinate_rate * step_s, rb = after.coordinate_rate * step_s;
  const double s2 = s * s, s3 = s2 * s;
  truth.coordinate =
      (2 * s3 - 3 * s2 + 1) * a + (s3 - 2 * s2 + s) * ra + (3 * s2 - 2 * s3) * b + (s3 - s2) * rb;
  truth.coordinate_rate = line(before.coordinate_rate, after.coordinate_rate);
  truth.position_m = jaw.followed_position_m(truth.coordinate);
  truth.velocity_m_s = jaw.followed_slope(truth.coordinate) * truth.coordinate_rate;
  truth.acceleration_m_s2 = line(before.acceleration_m_s2, after.acceleration_m_s2);
  for (std::size_t i = 0; i < kCauses; ++i) {
    truth.force_N[i] = line(before.force_N[i], after.force_N[i]);
    truth.work_J[i] = line(before.work_J[i], after.work_J[i]);
    truth.impulse[i] = line(before.impulse[i], after.impulse[i]);
  }
  for (std::size_t n = 0; n < kMostMuscles; ++n) {
    truth.activation[n] = line(before.activation[n], after.activation[n]);
    truth.excitation[n] = before.excitation[n];
  }
  truth.kinetic_energy_J = line(before.kinetic_energy_J, after.kinetic_energy_J);
  truth.momentum = line(before.momentum, after.momentum);
  truth.bristle_m = line(before.bristle_m, after.bristle_m);
  truth.food_height_m = line(before.food_height_m, after.food_height_m);
  truth.effective_mass_kg = line(before.effective_mass_kg, after.effective_mass_kg);
  truth.effective_friction_Ns_m =
      line(before.effective_friction_Ns_m, after.effective_friction_Ns_m);
  return truth;
}

Simulation::Simulation(const Scenario& scenario, std::uint64_t seed)
    : scenario_(scenario),
      subject_(scenario.subject, seed),
      facebow_(scenario.facebow, scenario.axis, seed),
      drive_noise_(seed, kDriveStream),
      emg_noise_(seed, kEmgStream),
      head_noise_(seed, kHeadStream),
      drive_{scenario.drive.rate_Hz, scenario.drive.delay_s},
      emg_{scenario.emg.rate_Hz, scenario.emg.delay_s},
      head_{scenario.head.rate_Hz, scenario.head.delay_s},
      before_(subject_.truth()),
      after_(before_) {}

bool Simulation::advance(SimulatedData& data) {
  const double wanted_s = facebow_.next_instant_s();
  if (wanted_s >= scenario_.duration_s) return false;
  while (after_.time_s < wanted_s) {
    subject_.step();
    before_ = after_;
    after_ = subject_.truth();
    read_channels(data);
    if (!std::isfinite(after_.position_m) || !std::isfinite(after_.velocity_m_s) ||
        !std::isfinite(after_.acceleration_m_s2)) {
      throw InputError(scenario_.name,
                       fmt::format("the simulation became unstable at {:.6g} s", after_.time_s),
                       "raise steps_per_millisecond in [subject], or make the forces less stiff");
    }
  }
  if (wanted_s == 0) read_channels(data);
  const SubjectTruth now = interpolate(scenario_.subject.jaw, before_, after_, wanted_s);
  data.truths.push_back(now);
  facebow_.sample(scenario_.subject.jaw, now.coordinate, data.samples);
  return true;
}

// A reading shows the state at its instant; its time stamp includes its delay.
void Simulation::read_channels(SimulatedData& data) {
  const auto read = [this](Channel& channel, auto&& take) {
    while (channel.rate_Hz > 0 && channel.next_instant_s() <= after_.time_s) {
      const double instant_s = channel.next_instant_s();
      Reading reading;
      reading.time_ns = nanoseconds(instant_s + channel.delay_s);
      take(interpolate(scenario_.subject.jaw, before_, after_, instant_s), reading);
      ++channel.count;
    }
  };
  read(drive_, [&](const SubjectTruth& truth, Reading& reading) {
    const DriveModel& model = scenario_.drive;
    const double muscle_N = truth.force_N[static_cast<std::size_t>(Cause::muscle)];
    const double load_N = truth.force_N[static_cast<std::size_t>(Cause::load)];
    const double seen_N = (1 - model.missing_share) * muscle_N + load_N -
                          model.missing_in_phase_Ns_m * truth.velocity_m_s;
    reading.values[0] = model.gain * seen_N + model.noise_N * drive_noise_.normal();
    data.drive.push_back(reading);
  });
  read(emg_, [&](const SubjectTruth& truth, Reading& reading) {
    for (std::size_t n = 0; n < scenario_.subject.jaw.muscles.size(); ++n) {
      const double envelope =
          scenario_.emg.gain * (1 - scenario_.emg.missing_share) * truth.excitation[n] +
          scenario_.emg.noise * emg_noise_.normal();
      reading.values[n] = std::max(0.0, envelope);
    }
    data.emg.push_back(reading);
  });
  read(head_, [&](const SubjectTruth& truth, Reading& reading) {
    constexpr double kGravity_m_s2 = 9.81;
    const double drive_N = truth.force_N[static_cast<std::size_t>(Cause::muscle)];
    const double felt_m_s2 = kGravity_m_s2 - drive_N / scenario_.subject.jaw.mass_kg;
    reading.values[0] =
        scenario_.head.gain * felt_m_s2 + scenario_.head.noise_m_s2 * head_noise_.normal();
    data.head.push_back(reading);
  });
}

}  // namespace condyle::host
