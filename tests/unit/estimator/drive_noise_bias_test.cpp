// SPDX-License-Identifier: Apache-2.0
// What the noise of the drive adds to the score, against a filter that is run at either side.
#include "condyle/estimator/impedance/drive_noise_bias.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "support/sanitizer.h"

namespace condyle {
namespace {

using Bias = DriveNoiseBias<double>;

struct Rates : DrivenRates<double> {
  double tau_s = 0;
};

constexpr std::array<double Rates::*, 4> kParameters = {&Rates::lambda, &Rates::eta, &Rates::kappa,
                                                        &Rates::tau_s};
constexpr double kT_s = 0.02;

struct Noise {
  double position_variance = 1e-8, velocity_variance = 0, drive_variance = 0.04;
  double force_density = 0;  // of white acceleration (m^2/s^3)
};

struct Sample {
  double z, u;
};

// A point that a drive of two tones moves, and its measurements with noise.
std::vector<Sample> record(const Rates& rates, const Noise& noise, int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  double p = 0.001, v = std::sqrt(noise.velocity_variance) * normal(random), before = 0;
  std::vector<Sample> samples;
  for (int k = 0; k < count; ++k) {
    const double t = kT_s * k, u = std::sin(8 * t) + 0.7 * std::sin(19 * t + 1);
    if (k > 0) {
      const auto step = driven_step<double>(rates, kT_s, p, v, before, u);
      const double kick = std::sqrt(noise.force_density * kT_s) * normal(random);
      const double shift = std::sqrt(noise.force_density * kT_s / 12) * kT_s * normal(random);
      p = step.position[kSolution] + kick * kT_s / 2 + shift;
      v = step.velocity[kSolution] + kick;
    }
    before = u;
    samples.push_back({p + std::sqrt(noise.position_variance) * normal(random),
                       u + std::sqrt(noise.drive_variance) * normal(random)});
  }
  return samples;
}

// Of each sample but the first.
struct Pass {
  std::vector<double> innovation, S;
  std::vector<Eigen::Vector4d> gain;
  std::vector<Eigen::Vector4d> added;
};

// The linear filter at given parameters; with the gains of `like`, if that is given.
Pass filter(const Rates& rates, const Noise& noise, const std::vector<Sample>& samples,
            const Pass* like = nullptr) {
  Pass pass;
  Bias bias;
  bias.drive(noise.drive_variance);
  bias.start(noise.position_variance, noise.velocity_variance);
  double p = samples[0].z, v = 0, u = samples[0].u;
  const auto response = driven_response<double>(rates, kT_s);
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const double begin = rates.tau_s / kT_s, end = 1 + begin;
    const auto drive_at = [&](double share) { return u + share * (samples[k].u - u); };
    const auto step = driven_step<double>(rates, response, p, v, drive_at(begin), drive_at(end));
    bias.drive(noise.drive_variance);
    bias.predict(rates, response, begin, end, kT_s, noise.force_density, kT_s);
    const double S = bias.covariance()(0, 0) + noise.position_variance;
    const Eigen::Vector4d own = bias.covariance().dense().col(0) / S;
    const Eigen::Vector4d gain = like == nullptr ? own : like->gain[k - 1];
    const double innovation = samples[k].z - step.position[kSolution];
    p = step.position[kSolution] + gain[0] * innovation;
    v = step.velocity[kSolution] + gain[1] * innovation;
    u = samples[k].u + gain[3] * innovation;
    pass.innovation.push_back(innovation);
    pass.S.push_back(S);
    pass.gain.push_back(own);
    pass.added.push_back(bias.update(noise.position_variance));
  }
  return pass;
}

struct Sides {
  Rates above, below;
  double width;
};

Sides sides(const Rates& rates, double Rates::*parameter) {
  const double h =
      parameter == &Rates::tau_s ? 1e-6 : 1e-4 * std::max(1.0, std::abs(rates.*parameter));
  Sides sides{rates, rates, 2 * h};
  sides.above.*parameter += h;
  sides.below.*parameter -= h;
  return sides;
}

constexpr Rates kRates{{2, 4, 60, 0.3}, 0};

// C is half the derivative of S, and what is added makes the score the gradient of sum r^2 / S / 2.
TEST(DriveNoiseBias, MakesTheScoreTheGradientOfTheCriterion) {
  const Noise noise;
  const auto samples = record(kRates, noise, 40, 1);
  const Pass here = filter(kRates, noise, samples);
  for (std::size_t i = 0; i < kParameters.size(); ++i) {
    const Sides at = sides(kRates, kParameters[i]);
    const Pass above = filter(at.above, noise, samples), below = filter(at.below, noise, samples);
    double of_criterion = 0, score = 0;
    for (std::size_t k = 0; k < here.S.size(); ++k) {
      const double S = here.S[k], r = here.innovation[k];
      const double of_S = (above.S[k] - below.S[k]) / at.width;
      EXPECT_NEAR(here.added[k][static_cast<int>(i)], of_S / S / 2,
                  1e-6 + 1e-4 * std::abs(of_S / S))
          << i << ' ' << k;
      of_criterion += (above.innovation[k] * above.innovation[k] / above.S[k] -
                       below.innovation[k] * below.innovation[k] / below.S[k]) /
                      at.width / 2;
      const double sensitivity = -(above.innovation[k] - below.innovation[k]) / at.width;
      score += sensitivity * r / S + here.added[k][static_cast<int>(i)] * r * r / S;
    }
    EXPECT_NEAR(score, -of_criterion, 1e-3 * std::abs(of_criterion)) << i;
  }
}

// At the true parameters the score is zero on average with it, and not without it; also where the
// first velocity and a force are not known.
TEST(DriveNoiseBias, MakesTheScoreZeroAtTheTruth) {
  if (CONDYLE_UNDER_SANITIZER) GTEST_SKIP() << "a statistic: shorter tests run the same code";
  constexpr int kRuns = 2000;
  for (const Noise& noise : {Noise{}, Noise{1e-8, 0.01, 0.04, 0}, Noise{1e-8, 0.01, 0.04, 0.1}}) {
    std::array<double, kParameters.size()> with{}, with_squares{}, without{};
    for (unsigned seed = 1; seed <= kRuns; ++seed) {
      const auto samples = record(kRates, noise, 40, seed);
      const Pass here = filter(kRates, noise, samples);
      for (std::size_t i = 0; i < kParameters.size(); ++i) {
        const Sides at = sides(kRates, kParameters[i]);
        const Pass above = filter(at.above, noise, samples, &here);
        const Pass below = filter(at.below, noise, samples, &here);
        double score = 0, added = 0;
        for (std::size_t k = 0; k < here.S.size(); ++k) {
          const double S = here.S[k], r = here.innovation[k];
          score -= (above.innovation[k] - below.innovation[k]) / at.width * r / S;
          added += here.added[k][static_cast<int>(i)] * r * r / S;
        }
        without[i] += score / kRuns;
        with[i] += (score + added) / kRuns;
        with_squares[i] += (score + added) * (score + added) / kRuns;
      }
    }
    for (std::size_t i = 0; i < kParameters.size(); ++i) {
      const double sd = std::sqrt(with_squares[i] / kRuns);
      EXPECT_LT(std::abs(with[i]), 3.5 * sd) << i << ' ' << noise.force_density;
      if (kParameters[i] == &Rates::eta) {
        EXPECT_LT(without[i], -10 * sd);
      }
    }
  }
}

// After a loss, the new first position is independent of the old ones and of the drive, which goes
// on.
TEST(DriveNoiseBias, AStartForgetsThePointAndKeepsTheDrive) {
  constexpr double kPosition = 4e-10, kVelocity = 0.02;
  const DrivenRates<double> rates{2, 4, 60, 0.3};
  DriveNoiseBias<double> bias;
  bias.drive(1e-4);
  bias.start(1e-10, 0.01);
  for (int k = 0; k < 10; ++k) {
    bias.drive(1e-4);
    bias.predict(rates, driven_response(rates, kT_s), 0, 1, kT_s, 0.01, kT_s);
    bias.update(1e-10);
  }
  const SymmetricMatrix<double, 4> before = bias.covariance();
  ASSERT_NE(before(0, 3), 0);
  bias.start(kPosition, kVelocity);
  const SymmetricMatrix<double, 4>& after = bias.covariance();
  EXPECT_EQ(after(0, 0), kPosition);
  EXPECT_EQ(after(1, 1), kVelocity);
  EXPECT_EQ(after(0, 1), 0);
  for (const int drive : {2, 3}) {
    EXPECT_EQ(after(0, drive), 0) << drive;
    EXPECT_EQ(after(1, drive), 0) << drive;
    for (const int other : {2, 3}) EXPECT_EQ(after(drive, other), before(drive, other));
  }
}

}  // namespace
}  // namespace condyle
