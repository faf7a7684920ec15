// SPDX-License-Identifier: Apache-2.0
#include "learning/course.h"

#include <cmath>
#include <limits>
#include <memory>

#include "condyle/estimator/sensors/learned_sensor.h"
#include "consistency/motion_vectors.h"
#include "simulation/scenario_file.h"
#include "support/paths.h"

namespace condyle::testing_support {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void Course::add(double time_s, double measured_m, double velocity, double acceleration) {
  Sample sample;
  sample.time_ns = nanoseconds(time_s);
  sample.kind = SampleKind::one_axis;
  sample.coordinates[0] = measured_m;
  sample.position_valid = std::isfinite(measured_m);
  samples.push_back(sample);
  velocity_m_s.push_back(velocity);
  acceleration_m_s2.push_back(acceleration);
}

Course simulate_course(const CourseSettings& settings, std::uint64_t seed) {
  host::Scenario scenario =
      host::load_scenario(source_path("/host_sim/scenarios/") + settings.scenario + ".toml");
  scenario.duration_s = settings.duration_s;
  if (settings.is_regular) {
    scenario.subject.task.rate_spread = 0.03;
    scenario.subject.task.amplitude_spread = 0.05;
    scenario.subject.task.pause_probability = 0;
  }
  if (settings.tremor_m >= 0) scenario.subject.task.tremor_m = settings.tremor_m;
  host::FacebowModel& facebow = scenario.facebow;
  facebow.rate_Hz = settings.rate_Hz;
  facebow.noise_m = settings.noise_m;
  facebow.noise_rad = 0;
  facebow.gives_points = false;
  facebow.jitter_s = settings.jitter_s;
  facebow.smoothing = settings.smoothing;
  facebow.quantum_m = settings.quantum_m;
  facebow.lost_share = settings.lost_share;
  facebow.glitch_share = settings.glitch_share;
  if (settings.has_faults) {
    facebow.dropout = {20, 0.5};
    facebow.frozen = {40, 0.5};
  }
  Course course;
  course.rate_Hz = settings.rate_Hz;
  host::Simulation simulation(scenario, seed);
  host::SimulatedData data;
  for (bool goes_on = true; goes_on; data.clear()) {
    goes_on = simulation.advance(data);
    for (const Sample& sample : data.samples) {  // at most one for a truth: none is repeated
      const host::SubjectTruth& truth = data.truths.back();
      course.samples.push_back(sample);
      course.velocity_m_s.push_back(truth.velocity_m_s);
      course.acceleration_m_s2.push_back(truth.acceleration_m_s2);
    }
  }
  return course;
}

Course read_course(const std::string& name) {
  const MotionVector motion = read_motion(name);
  Course course;
  course.rate_Hz = 1 / seconds(motion.time_ns[1] - motion.time_ns[0]);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    course.add(seconds(motion.time_ns[i]), motion.is_measured[i] ? motion.position_m[i] : kUnknown,
               motion.velocity_m_s[i], kUnknown);
  }
  return course;
}

template <class Scalar>
std::vector<CourseScore> score_course(const Course& course, int kernels, int lag,
                                      const std::vector<CourseStretch>& stretches) {
  using Sensor = LearnedSensor<RecommendedSensor<Scalar, 1>, Scalar, 1, 16, kMostKernels>;
  DrivenParameters parameters;
  parameters.learning.kernels = kernels;
  const auto sensor = std::make_unique<Sensor>(parameters, lag);
  SampleChecker checker(nanoseconds(1 / course.rate_Hz));
  std::vector<CourseScore> scores(stretches.size());
  std::size_t done = 0;
  const auto add = [&](const auto& estimate) {
    if (!estimate.is_ready) return;
    const std::size_t i = done++;
    const auto& axis = estimate.axes[0];
    const double t = seconds(course.samples[i].time_ns - course.samples[0].time_ns);
    const double v = static_cast<double>(axis.velocity_m_s.value) - course.velocity_m_s[i];
    const double a =
        static_cast<double>(axis.acceleration_m_s2.value) - course.acceleration_m_s2[i];
    if (!std::isfinite(v)) return;
    const auto holds = [](double error, Scalar deviation) {
      return std::abs(error) <= kNormalQuantile95 * static_cast<double>(deviation);
    };
    for (std::size_t k = 0; k < stretches.size(); ++k) {
      if (t < stretches[k].from_s || t >= stretches[k].to_s) continue;
      CourseScore& score = scores[k];
      ++score.samples;
      score.velocity_error_m_s += v * v;
      score.acceleration_error_m_s2 += a * a;
      score.velocity_held += holds(v, axis.velocity_m_s.standard_deviation) ? 1 : 0;
      score.acceleration_held += holds(a, axis.acceleration_m_s2.standard_deviation) ? 1 : 0;
      score.corrected += static_cast<double>(axis.velocity_learned);
    }
  };
  for (const Sample& sample : course.samples) {
    add(sensor->process(sample, checker.check(sample)));
  }
  typename Sensor::Estimate estimate;
  while (sensor->drain(estimate)) add(estimate);
  for (CourseScore& score : scores) {
    const auto n = static_cast<double>(score.samples);
    score.velocity_error_m_s = std::sqrt(score.velocity_error_m_s / n);
    score.acceleration_error_m_s2 = std::sqrt(score.acceleration_error_m_s2 / n);
    score.velocity_held /= n;
    score.acceleration_held /= n;
    score.corrected /= n;
  }
  return scores;
}

template std::vector<CourseScore> score_course<double>(const Course&, int, int,
                                                       const std::vector<CourseStretch>&);
template std::vector<CourseScore> score_course<float>(const Course&, int, int,
                                                      const std::vector<CourseStretch>&);

}  // namespace condyle::testing_support
