// SPDX-License-Identifier: Apache-2.0
#include "tuning/tuned_learning.h"

#include <cmath>
#include <memory>

namespace condyle::host {
namespace {

// Kept stretches do not follow each other: the motion begins anew.
constexpr double kBetweenStretches_s = 60;

}  // namespace

LearningCounts learning_with(const RecommendedParameters& parameters,
                             const std::vector<TuningRecording>& recordings) {
  using Sensor = LearnedSensor<RecommendedSensor<double, 1>, double, 1, 16, kMostKernels>;
  LearningCounts all;
  for (const TuningRecording& recording : recordings) {
    const auto sensor = std::make_unique<Sensor>(parameters);
    if (!sensor->learns()) return {};
    double time_s = 0;
    for (const TuningSample& kept : recording.samples) {
      time_s += kept.step_s > 0 ? kept.step_s : kBetweenStretches_s;
      Sample sample;
      sample.time_ns = nanoseconds(time_s);
      sample.kind = SampleKind::one_axis;
      sample.position_valid = std::isfinite(kept.position_m);
      sample.coordinates[0] = kept.position_m;
      (void)sensor->process(sample, {});
    }
    const LearningCounts& counts = sensor->learning(0);
    all.samples += counts.samples;
    all.corrected += counts.corrected;
    all.compared += counts.compared;
    all.filter_square_m2 += counts.filter_square_m2;
    all.corrected_square_m2 += counts.corrected_square_m2;
  }
  return all;
}

}  // namespace condyle::host
