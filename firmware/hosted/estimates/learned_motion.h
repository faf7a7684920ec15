// SPDX-License-Identifier: Apache-2.0
// What a recording has taught (learned_sensor.h), to be kept for another one of the same subject.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace condyle::host {

/// What was learned along one axis, by name (MotionCorrector::visit_learned).
struct LearnedAxis {
  int kernels = 0;
  std::map<std::string, std::vector<double>> values;
};

/// What a recording has taught, axis by axis.
struct LearnedMotion {
  double rate_Hz = 0;  ///< of the recording; 0: not known
  int lag = 0;         ///< of the estimates (samples)
  std::vector<LearnedAxis> axes;
};

/// The format of a file of it.
inline constexpr const char* kLearnedFormat = "condyle-learned-1";
/// The text of such a file, as JSON.
std::string learned_text(const LearnedMotion& learned);

/// What `sensor`, a LearnedSensor for `axis_count` axes, has learned.
template <class Sensor>
LearnedMotion learned_of(Sensor& sensor, int axis_count) {
  LearnedMotion learned;
  const auto step_s = static_cast<double>(sensor.mean_step_s());
  learned.rate_Hz = step_s > 0 ? 1 / step_s : 0;
  learned.lag = sensor.estimator().lag();
  for (int axis = 0; axis < axis_count; ++axis) {
    LearnedAxis& one = learned.axes.emplace_back();
    auto& corrector = sensor.corrector(axis);
    one.kernels = corrector.kernels();
    corrector.visit_learned([&one](const char* name, const auto* first, int count) {
      one.values[name].assign(first, first + count);
    });
  }
  return learned;
}

/// Begins with `learned`, which read_learned has checked, before the first sample.
template <class Sensor>
void begin_with(Sensor& sensor, const LearnedMotion& learned) {
  for (std::size_t axis = 0; axis < learned.axes.size(); ++axis) {
    const LearnedAxis& one = learned.axes[axis];
    auto& corrector = sensor.corrector(static_cast<int>(axis));
    corrector.begin_with(one.kernels);
    corrector.visit_learned([&one](const char* name, auto* first, int count) {
      const std::vector<double>& values = one.values.at(name);
      std::copy(values.begin(), values.begin() + count, first);
    });
  }
}

}  // namespace condyle::host
