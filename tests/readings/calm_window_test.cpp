// SPDX-License-Identifier: Apache-2.0
// Strokes with stops: how far they may be smoothed, and the smoothness of what is not smooth.
#include "readings/calm_window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "readings/smoothness.h"
#include "statistics/random.h"

namespace condyle::host {
namespace {

constexpr double kNoise_m = 5e-5, kNoise_rad = 1e-3, kWidest_s = 0.16, kLeast_s = 0.06;

PoseNoise white_noise() {
  PoseNoise noise;
  noise.covariance.diagonal() << Eigen::Vector3d::Constant(kNoise_m * kNoise_m),
      Eigen::Vector3d::Constant(kNoise_rad * kNoise_rad);
  return noise;
}

// Three seconds along the direction (1, 0, -1), with noise.
ReferredMotion moved(double rate_Hz, std::uint64_t seed,
                     const std::function<double(double)>& place_m) {
  ReferredMotion motion;
  RandomGenerator random(seed);
  for (double t = 0; t < 3; t += 1 / rate_Hz) {
    Vector6 value;
    for (int i = 0; i < 6; ++i) value[i] = (i < 3 ? kNoise_m : kNoise_rad) * random.normal();
    value[0] += place_m(t);
    value[2] -= place_m(t);
    motion.time_s.push_back(t);
    motion.motion.push_back(value);
  }
  return motion;
}

double least_jerk(double share) {
  const double u = std::clamp(share, 0.0, 1.0);
  return u * u * u * (10 - 15 * u + 6 * u * u);
}

double half_width_s(const ReferredMotion& motion) {
  return calm_half_width_s(motion, 0, motion.time_s.size(), white_noise(), kWidest_s, kLeast_s);
}

// Of 800 motions that a cubic follows. The mean of q lies six standard deviations and half its size
// above 1 with less than 1e-9 in each of some 500 windows.
TEST(CalmWindow, StaysWideForASlowMotion) {
  for (const double rate_Hz : {60.0, 100.0, 200.0, 500.0}) {
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      const auto motion =
          moved(rate_Hz, seed, [](double t) { return 0.03 * least_jerk((t - 0.2) / 2.6); });
      ASSERT_EQ(half_width_s(motion), kWidest_s) << rate_Hz << " Hz, seed " << seed;
    }
  }
}

// A stroke of 12 mm that stops for 0.1 s on its way.
TEST(CalmWindow, BecomesNarrowForAStop) {
  for (const double rate_Hz : {60.0, 100.0, 200.0, 500.0}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const auto motion = moved(rate_Hz, seed, [](double t) {
        return 0.006 * (least_jerk((t - 1) / 0.3) + least_jerk((t - 1.4) / 0.3));
      });
      EXPECT_LT(half_width_s(motion), kWidest_s) << rate_Hz << " Hz, seed " << seed;
      EXPECT_GE(half_width_s(motion), kLeast_s);
      const auto quick = moved(rate_Hz, seed, [](double t) {
        return 0.006 * (least_jerk((t - 1) / 0.15) + least_jerk((t - 1.25) / 0.15));
      });
      EXPECT_LT(half_width_s(quick), 0.6 * kWidest_s) << rate_Hz << " Hz, seed " << seed;
    }
  }
}

TEST(CalmWindow, NeedsNoNoise) {
  PoseNoise none;
  auto motion = moved(200, 1, [](double) { return 0; });
  for (std::size_t k = 0; k < motion.time_s.size(); ++k) {
    motion.motion[k] = Vector6::Constant(1e-3 * motion.time_s[k]);
  }
  EXPECT_EQ(calm_half_width_s(motion, 0, motion.time_s.size(), none, kWidest_s, kLeast_s),
            kWidest_s);
  motion.motion[300][2] += 1e-3;
  EXPECT_EQ(calm_half_width_s(motion, 0, motion.time_s.size(), none, kWidest_s, kLeast_s),
            kLeast_s);
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
