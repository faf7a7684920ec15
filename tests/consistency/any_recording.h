// SPDX-License-Identifier: Apache-2.0
// Recordings along one axis, drawn over wider ranges than any at hand, and what the recommended
// sensor makes of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "condyle/estimator/sensors/recommended_sensor.h"
#include "support/random.h"

namespace condyle::testing_support {

using Sensor = RecommendedSensor<double, 1>;
using Estimates = std::vector<RecommendedEstimate<double>>;

struct Recording {
  std::vector<Sample> samples;
  std::vector<double> truth_m;

  void add(double t, double truth, double measured, bool is_measured = true) {
    Sample sample;
    sample.time_ns = nanoseconds(t);
    sample.coordinates[0] = measured;
    sample.position_valid = is_measured;
    samples.push_back(sample);
    truth_m.push_back(truth);
  }
};

inline Estimates run(const Recording& recording, double rate_Hz) {
  Sensor sensor(MotionEstimatorParameters{});
  SampleChecker checker(nanoseconds(1 / rate_Hz));
  Estimates estimates;
  for (const Sample& sample : recording.samples) {
    estimates.push_back(sensor.process(sample, checker.check(sample)));
  }
  return estimates;
}

inline double log_between(Random& random, double lowest, double highest) {
  return lowest * std::pow(highest / lowest, random.uniform());
}
inline std::size_t index_below(Random& random, std::size_t count) {
  return std::min(static_cast<std::size_t>(random.uniform() * static_cast<double>(count)),
                  count - 1);
}

// A course of least jerk (T. Flash, N. Hogan, J. Neurosci. 5 (1985) 1688) from 0 to 1.
inline double minimum_jerk(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  return s * s * s * (10 - 15 * s + 6 * s * s);
}

// Chewing of some rhythm and height with its second harmonic.
inline std::function<double(double)> any_chewing(Random& random) {
  const double w = 2 * std::numbers::pi * (0.6 + 1.4 * random.uniform());
  const double height_m = log_between(random, 2e-3, 20e-3), phase = 6 * random.uniform();
  return [=](double t) {
    return height_m * (0.5 * std::sin(w * t + phase) + 0.1 * std::sin(2 * w * t));
  };
}

// Offsets of a burst of glitches, in metres.
inline double burst_m(int shape, double size_m, std::size_t i, Random& random) {
  const auto k = static_cast<double>(i);
  switch (shape) {
    case 0:
      return size_m;
    case 1:
      return i % 2 == 0 ? size_m : -size_m;
    case 2:
      return size_m * (1 + k);
    case 3:
      return size_m * (2 * random.uniform() - 1);
    default:
      return size_m * random.normal();
  }
}

inline bool is_shown(const RecommendedEstimate<double>& estimate) {
  return std::isfinite(estimate.axes[0].position_m.value);
}

// From `begin` to before `end` the truth is within 5 sd, and no sample is refused.
inline bool is_followed(const Recording& recording, const Estimates& estimates, std::size_t begin,
                        std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    const auto& position = estimates[i].axes[0].position_m;
    const double error_m = std::abs(position.value - recording.truth_m[i]);
    if (!(error_m <= 5 * position.standard_deviation)) return false;
    if (estimates[i].events.has(Event::outlier_rejected)) return false;
  }
  return true;
}

constexpr std::array kRates_Hz = {60.0, 100.0, 200.0, 500.0, 1000.0};

/// Once for each of kRates_Hz.
class AtAnyRate : public testing::TestWithParam<double> {
 protected:
  double rate_Hz() const { return GetParam(); }
};

}  // namespace condyle::testing_support
