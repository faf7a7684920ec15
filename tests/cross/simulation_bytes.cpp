// SPDX-License-Identifier: Apache-2.0
// Prints a simulated recording, its truth and its estimates, every digit: the same on every
// machine. Built for this machine and for others, and compared.
#include <cstdio>

#include "condyle/estimator/published/published_cascade.h"
#include "condyle/estimator/sensors/recommended_sensor.h"
#include "hosted/files/number_text.h"
#include "simulation/recording_writer.h"

namespace condyle::host {
namespace {

void print(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
}

void print_run(const Scenario& scenario) {
  Simulation simulation(scenario, scenario.seed);
  RecordingWriter writer(scenario);
  PublishedParameters parameters;
  parameters.sample_time_s = 1 / scenario.facebow.rate_Hz;
  PublishedCascade<double> cascade(parameters);
  FollowedPoint condyle_point;
  if (scenario.facebow.gives_points) condyle_point.body_point_m = Eigen::Vector3d(0.05, 0.03, 0.09);
  RecommendedSensor<double, 3> recommended(MotionEstimatorParameters{}, 3, condyle_point);
  RecommendedSensor<float, 3> in_float(MotionEstimatorParameters{});
  SampleChecker checker(nanoseconds(parameters.sample_time_s));
  SimulatedData data;
  while (simulation.advance(data)) {
    for (const Sample& sample : data.samples) {
      print(writer.recording_row(sample));
      const auto estimate = cascade.step(followed_position_m(sample, {}));
      std::string row;
      append_number(row, estimate.friction_Ns_m.value);
      row += ' ';
      append_number(row, estimate.mass_kg.value);
      const EventSet events = checker.check(sample);
      for (const double value :
           {recommended.process(sample, events).axes[2].velocity_m_s.value,
            static_cast<double>(in_float.process(sample, events).axes[1].velocity_m_s.value)}) {
        row += ' ';
        append_number(row, value);
      }
      print(row + '\n');
    }
    for (const SubjectTruth& truth : data.truths) print(writer.truth_row(truth));
    for (const Reading& reading : data.drive) print(writer.value_row(reading));
    for (const Reading& reading : data.emg) print(writer.emg_row(reading));
    data.clear();
  }
}

}  // namespace
}  // namespace condyle::host

int main() {
  using namespace condyle::host;
  Scenario chewing;
  chewing.duration_s = 10;
  chewing.subject.jaw = tabulated_hinge_jaw("anybody");
  chewing.subject.task = {.amplitude_m = 0.02,
                          .amplitude_spread = 0.1,
                          .rate_spread = 0.1,
                          .pause_probability = 0.1,
                          .tremor_m = 1e-5};
  chewing.subject.food_height_m = 0.004;
  chewing.subject.friction.model = FrictionModel::lugre;
  chewing.facebow.glitch_share = 0.01;
  chewing.facebow.jitter_s = 1e-3;
  chewing.facebow.quantum_m = 1e-5;
  chewing.drive.rate_Hz = 200;
  chewing.emg.rate_Hz = 100;
  print_run(chewing);

  Scenario stribeck = chewing;
  stribeck.subject.jaw = tabulated_translation_jaw("artisynth");
  stribeck.axis = condyle::Axis::x;
  stribeck.subject.friction.model = FrictionModel::stribeck;
  stribeck.subject.friction_schedule = {FrictionSchedule::Shape::ramp, 2, 5, 3};
  stribeck.subject.friction.coulomb_N = 0.05;
  stribeck.subject.friction.static_N = 0.08;
  stribeck.subject.steps_per_millisecond =
      static_cast<int>(needed_steps_per_millisecond(stribeck.subject));
  stribeck.facebow.gives_points = false;
  print_run(stribeck);
}
