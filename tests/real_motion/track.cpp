// SPDX-License-Identifier: Apache-2.0
#include "real_motion/track.h"

#include <cmath>
#include <limits>
#include <memory>

#include "condyle/estimator/sensors/learned_sensor.h"
#include "condyle/estimator/sensors/published_sensor.h"

namespace condyle::testing_support {
namespace {

std::vector<Sample> samples_of(const MotionRecording& recording) {
  const std::size_t axes = recording.position_m.size();
  std::vector<Sample> samples(recording.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Sample& sample = samples[i];
    sample.kind = axes == 1 ? SampleKind::one_axis : SampleKind::one_point;
    sample.time_ns = nanoseconds(recording.time_s[i]);
    sample.sequence = i;
    sample.position_valid = recording.is_measured(i);
    for (std::size_t axis = 0; sample.position_valid && axis < axes; ++axis) {
      sample.coordinates[axis] = recording.position_m[axis][i];
    }
  }
  return samples;
}

template <int kAxes>
std::vector<Track> recommended(const MotionRecording& recording, int kernels) {
  using Sensor = LearnedSensor<RecommendedSensor<double, kAxes>, double, kAxes, 16, kMostKernels>;
  std::vector<Track> tracks(kAxes, Track(recording.size()));
  DrivenParameters parameters;
  parameters.learning.kernels = kernels;
  const auto sensor = std::make_unique<Sensor>(parameters);
  SampleChecker checker(nanoseconds(recording.step_s()));
  for (const Sample& sample : samples_of(recording)) {
    const auto estimate = sensor->process(sample, checker.check(sample));
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      const auto& said = estimate.axes[axis];
      const auto i = static_cast<std::size_t>(sample.sequence);
      const bool restarts = estimate.events.has(Event::state_restarted);
      Track& track = tracks[axis];
      track.position_m[i] = said.position_m.value;
      track.position_sd_m[i] = said.position_m.standard_deviation;
      track.velocity_m_s[i] = said.velocity_m_s.value;
      track.velocity_sd_m_s[i] = said.velocity_m_s.standard_deviation;
      track.innovation_m[i] = said.innovation_m;
      track.innovation_sd_m[i] = said.innovation_sd_m;
      track.is_refused[i] = estimate.events.has(Event::outlier_rejected) && !restarts;
      track.is_restarted[i] = restarts;
      track.is_repeated[i] = estimate.events.has(Event::position_repeated) ||
                             estimate.events.has(Event::position_frozen);
    }
  }
  return tracks;
}

}  // namespace

Track::Track(std::size_t samples)
    : is_refused(samples, false), is_repeated(samples, false), is_restarted(samples, false) {
  for (Values* const values : {&position_m, &position_sd_m, &velocity_m_s, &velocity_sd_m_s,
                               &innovation_m, &innovation_sd_m}) {
    values->assign(samples, std::numeric_limits<double>::quiet_NaN());
  }
}

std::vector<Track> recommended_tracks(const MotionRecording& recording, int kernels) {
  return recording.position_m.size() == 1 ? recommended<1>(recording, kernels)
                                          : recommended<3>(recording, kernels);
}

std::vector<Track> published_tracks(const MotionRecording& recording) {
  PublishedParameters parameters;
  parameters.sample_time_s = recording.step_s();
  const auto samples = samples_of(recording);
  std::vector<Track> tracks;
  for (std::size_t axis = 0; axis < recording.position_m.size(); ++axis) {
    const FollowedCoordinate followed{1, static_cast<Axis>(axis)};
    PublishedSensor<double> sensor(parameters, followed);
    SampleChecker checker(nanoseconds(recording.step_s()), false, followed);
    Track& track = tracks.emplace_back(recording.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto said = sensor.process(samples[i], checker.check(samples[i]));
      track.position_m[i] = said.position_m.value;
      track.position_sd_m[i] = said.position_m.standard_deviation;
      track.velocity_m_s[i] = said.velocity_m_s.value;
      track.velocity_sd_m_s[i] = said.velocity_m_s.standard_deviation;
      track.innovation_m[i] = said.innovation_m;
      track.innovation_sd_m[i] = std::abs(said.innovation_m) / std::sqrt(said.motion_nis);
    }
  }
  return tracks;
}

}  // namespace condyle::testing_support
