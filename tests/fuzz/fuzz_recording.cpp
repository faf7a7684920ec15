// SPDX-License-Identifier: Apache-2.0
// Any bytes as a recording: read through both estimators or refused with a message, nothing else.
#include <cmath>

#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/estimator/sensors/recommended_sensor.h"
#include "fuzz/memory_file.h"
#include "hosted/files/input_error.h"
#include "recordings/recording.h"

namespace {

// A value, its standard deviation and its provenance come together or not at all.
void check(const condyle::Quantity<double>& quantity) {
  const bool is_there = quantity.provenance != condyle::Provenance::not_computed;
  if (is_there != std::isfinite(quantity.value)) std::abort();
  if (is_there != std::isfinite(quantity.standard_deviation)) std::abort();
}

template <int kAxes>
void check(const condyle::RecommendedEstimate<double>& estimate) {
  for (int axis = 0; axis < kAxes; ++axis) {
    check(estimate.axes[axis].position_m);
    check(estimate.axes[axis].velocity_m_s);
    check(estimate.axes[axis].acceleration_m_s2);
    check(estimate.axes[axis].force_N);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  condyle::host::RecordingOptions options;
  options.faults =
      (data[0] & 1U) != 0 ? condyle::host::FaultPolicy::event : condyle::host::FaultPolicy::refuse;
  if ((data[0] & 2U) != 0) options.units_per_metre = 1000;
  const condyle::fuzz::MemoryFile file(data + 1, size - 1);
  try {
    const auto recording = condyle::host::open_recording(file.path(), options);
    condyle::PublishedSensor<double> published(condyle::PublishedParameters{});
    const int lag = data[0] >> 4U;
    condyle::RecommendedSensor<double, 1> along_one_axis(condyle::MotionEstimatorParameters{}, lag);
    condyle::FollowedPoint followed;
    if ((data[0] & 4U) != 0) followed.body_point_m = Eigen::Vector3d(0.01, 0.02, 0.09);
    condyle::RecommendedSensor<double, 3> along_three(condyle::MotionEstimatorParameters{}, lag,
                                                      followed);
    condyle::SampleChecker checker(16'666'667);
    condyle::Sample sample;
    while (recording->next(sample)) {
      const condyle::EventSet events = checker.check(sample);
      for (std::size_t i = 0; i < condyle::coordinate_count(sample.kind); ++i) {
        if (sample.position_valid && !std::isfinite(sample.coordinates[i])) std::abort();
      }
      static_cast<void>(published.process(sample, events));
      check<1>(along_one_axis.process(sample, events));
      check<3>(along_three.process(sample, events));
    }
    condyle::RecommendedEstimate<double> waiting;
    while (along_three.drain(waiting)) check<3>(waiting);
  } catch (const condyle::host::InputError&) {
  }
  return 0;
}
