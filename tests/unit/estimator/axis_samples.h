// SPDX-License-Identifier: Apache-2.0
// Samples of a swing along one axis, with everything that goes wrong on the way.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "support/rapidcheck_gtest.h"
#include "unit/estimator/dense_white_jerk.h"

namespace condyle::testing_support {

/// Whether samples that are far off, for good or once, are drawn.
enum class Far { drawn, left_out };

/// 1 s to 2 s of samples at irregular times: mostly ordinary ones with noise of `noise_sd_m`, some
/// missing, not numbers, displaced a little, far off (for good or once), repeated or reversed in
/// time, after a gap.
inline rc::Gen<std::vector<AxisSample>> troubled_samples(double noise_sd_m, Far far) {
  enum Trouble : int { none, missing, no_number, outlier, glitch, jump, repeated, reversed, gap };
  struct Draw {
    Trouble trouble;
    double step, noise;
  };
  const std::size_t often = far == Far::drawn ? 2 : 0;
  const auto trouble = rc::gen::weightedElement<Trouble>({{30, none},
                                                          {3, missing},
                                                          {1, no_number},
                                                          {2, outlier},
                                                          {often, glitch},
                                                          {often, jump},
                                                          {1, repeated},
                                                          {1, reversed},
                                                          {1, gap}});
  const auto draw = rc::gen::apply(
      [](Trouble kind, double step, double noise) {
        return Draw{kind, step, noise};
      },
      trouble, number_between(0, 1), number_between(-1.7, 1.7));
  return rc::gen::map(
      rc::gen::noShrink(rc::gen::container<std::vector<Draw>>(60, draw)),
      [=](const std::vector<Draw>& all) {
        std::vector<AxisSample> samples;
        TimeNs time_ns = 0;
        double offset_m = 0;
        for (const auto& [kind, step, noise] : all) {
          TimeNs step_ns = 5'000'000 + nanoseconds(0.03 * step);
          if (kind == gap) step_ns += 300'000'000;
          if (kind == repeated) step_ns = 0;
          if (kind != reversed) time_ns += step_ns;
          if (kind == jump) offset_m += 0.03 * (step - 0.5);
          AxisSample sample{time_ns - (kind == reversed ? 1'000'000 : 0), kind != missing, 0};
          const double t = seconds(sample.time_ns);
          sample.position_m = offset_m + 0.005 * std::sin(8 * t) + noise_sd_m * noise;
          if (kind == no_number) sample.position_m = std::numeric_limits<double>::quiet_NaN();
          if (kind == outlier) sample.position_m += 7 * noise_sd_m * (step > 0.5 ? 1 : -1);
          if (kind == glitch) sample.position_m += 0.5;
          samples.push_back(sample);
        }
        return samples;
      });
}

}  // namespace condyle::testing_support
