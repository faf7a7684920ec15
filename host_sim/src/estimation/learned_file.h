// SPDX-License-Identifier: Apache-2.0
// Keeps what a recording has taught (learned_sensor.h), to begin another one of the same subject.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace condyle::host {

/// Options for learning.
struct LearnedFiles {
  std::string begin_with;  ///< what an earlier recording taught; empty: nothing
  std::string out;         ///< for what this one teaches; empty: none

  bool are_given() const { return !begin_with.empty() || !out.empty(); }
  /// Throws InputError if they are given, but nothing is learned.
  void refuse_unless(bool learns) const;
};

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

/// The text of a file of it, as JSON.
std::string learned_text(const LearnedMotion& learned);
/// Reads such a file, or a session log that holds one. Throws InputError if it cannot be used along
/// `axis_count` axes, for samples `step_s` apart (0: not known), with `most_kernels` and `lag`.
LearnedMotion read_learned(const std::string& path, int axis_count, double step_s,
                           double most_kernels, int lag);

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
