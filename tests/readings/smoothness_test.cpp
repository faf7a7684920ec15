// SPDX-License-Identifier: Apache-2.0
#include "readings/smoothness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace condyle::host {
namespace {

// Values of the reference implementation of Balasubramanian et al. 2015.
TEST(Smoothness, EqualsThePublishedValues) {
  std::vector<double> speed;
  for (int i = -100; i < 100; ++i) speed.push_back(std::exp(-5 * (i * 0.01) * (i * 0.01)));
  EXPECT_NEAR(spectral_arc_length(speed, 0.01), -1.41403, 5e-6);
  EXPECT_NEAR(log_dimensionless_jerk(speed, 0.01), -5.81636, 5e-6);
}

TEST(Smoothness, OfAMinimumJerkStroke) {
  // 720 / 1.875^2 = 204.8 exactly.
  std::vector<double> speed;
  for (int i = 0; i <= 20000; ++i) {
    const double t = i / 20000.0;
    speed.push_back(30 * t * t * (1 - t) * (1 - t));
  }
  EXPECT_NEAR(std::exp(-log_dimensionless_jerk(speed, 1 / 20000.0)), 204.8, 0.1);
}

// The bins of the spectrum lie elsewhere at each rate, so that the arc length of a movement with
// stops differs. The difference is within what is said to be open.
TEST(Smoothness, OfMovementsWithStopsDiffersBetweenRatesByItsDoubt) {
  double worst = 0;
  for (const double part_s : {0.2, 0.3, 0.45, 0.7}) {
    for (const double stop_s : {0.0, 0.03, 0.1, 0.17, 0.3}) {
      for (const double second : {0.4, 1.0, 1.7}) {  // size of the second part over the first
        const double end_s = 2 * part_s + stop_s;
        const auto speed_at = [&](double t) {
          const auto bell = [&](double u) {
            return u > 0 && u < 1 ? u * u * (1 - u) * (1 - u) : 0;
          };
          return bell(t / part_s) + second * bell((t - part_s - stop_s) / part_s);
        };
        std::vector<Smoothness> all;
        for (const double rate_Hz : {100.0, 128.0, 200.0, 500.0, 1000.0, 2000.0}) {
          std::vector<double> time_s, speed;
          for (double t = 0; t <= end_s + 1e-9; t += 1 / rate_Hz) {
            time_s.push_back(t);
            speed.push_back(speed_at(t));
          }
          all.push_back(smoothness_of(time_s, speed, 0, end_s));
        }
        for (const Smoothness& one : all) {
          const Smoothness& fine = all.back();
          const double difference = std::abs(one.spectral_arc_length - fine.spectral_arc_length);
          worst = std::max(worst, difference);
          EXPECT_LE(difference, 0.01 + std::hypot(one.arc_length_doubt, fine.arc_length_doubt))
              << part_s << " s, stop " << stop_s << " s, second " << second;
        }
      }
    }
  }
  EXPECT_GT(worst, 0.03);  // the movements show what is to be doubted
}

}  // namespace
}  // namespace condyle::host
