// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/changes/cycle_damping.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "support/driven_chewing.h"
#include "support/random.h"

namespace condyle {
namespace {

using testing_support::DrivenChewing;
using testing_support::DrivenSample;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr DampingBaseline kBaseline{0.022, 0.25, 20, 0.2};

ImpedanceParameters matched() {
  ImpedanceParameters parameters;
  parameters.drive.noise_sd_N = DrivenChewing::kDriveSd_N;
  return parameters;
}

template <class Scalar>
CycleDamping<Scalar> stage_at(const DampingBaseline& baseline) {
  return CycleDamping<Scalar>(baseline, matched(), {});
}

template <class Scalar>
CycleReport<Scalar> take(CycleDamping<Scalar>& stage, const DrivenSample& sample, double T) {
  return stage.step(static_cast<Scalar>(T), static_cast<Scalar>(sample.drive_N),
                    static_cast<Scalar>(sample.position_m),
                    static_cast<Scalar>(DrivenChewing::kPositionSd_m));
}

// The cycles, of every outcome, of `seconds` of chewing.
template <class Scalar>
std::vector<CycleReport<Scalar>> cycles_of(CycleDamping<Scalar>& stage, DrivenChewing& chewing,
                                           double seconds) {
  std::vector<CycleReport<Scalar>> cycles;
  for (double t = 0; t < seconds; t += chewing.sample_time_s()) {
    const auto report = take(stage, chewing.next(), chewing.sample_time_s());
    if (report.outcome != CycleOutcome::none) cycles.push_back(report);
  }
  return cycles;
}

struct Motion {
  double p = 0, v = 0, a = 0;
};

// Of a point of the baseline's properties.
double drive_N(const Motion& motion) {
  return 0.25 * motion.a + 0.022 * motion.v + 20 * motion.p - 0.2;
}

DrivenSample with_noise(const Motion& motion, testing_support::Random& random) {
  return {motion.p + 5e-5 * random.normal(), drive_N(motion) + 0.01 * random.normal()};
}

// At `t`, in cycles of two harmonics.
Motion two_harmonics(double t, double cycle_Hz) {
  constexpr double A = 0.0075;
  const double w = 2 * std::numbers::pi * cycle_Hz, x = w * t;
  return {A * (0.8 - std::cos(x) + 0.2 * std::cos(2 * x)),
          A * w * (std::sin(x) - 0.4 * std::sin(2 * x)),
          A * w * w * (std::cos(x) - 0.8 * std::cos(2 * x))};
}

// Cycles of two harmonics; after each, the point stands still, longer every time. What it stands
// for is no part of them.
TEST(CycleDamping, CountsEveryCycleAndNoPause) {
  testing_support::Random random(1);
  for (const double rate_Hz : {50.0, 60.0, 200.0}) {
    for (const double cycle_Hz : {0.65, 0.9, 1.3, 1.6}) {
      for (const double pause_s : {0.0, 0.1}) {
        auto stage = stage_at<double>(kBaseline);
        const double T = 1 / rate_Hz;
        int ends = 0, counted = 0;
        const auto add = [&](const DrivenSample& sample) {
          const auto report = take(stage, sample, T);
          if (report.outcome == CycleOutcome::none) return;
          ++ends;
          counted += report.outcome == CycleOutcome::counted ? 1 : 0;
          EXPECT_GT(report.duration_s, 0.85 / cycle_Hz);
          EXPECT_LT(report.duration_s, 1 / cycle_Hz + 0.5);
        };
        for (int cycle = 0; cycle < 40; ++cycle) {
          for (double t = 0; t < 1 / cycle_Hz; t += T) {
            add(with_noise(two_harmonics(t, cycle_Hz), random));
          }
          for (double t = 0; t < pause_s * cycle; t += T) add(with_noise({}, random));
        }
        EXPECT_NEAR(ends, 39, 1) << rate_Hz << ' ' << cycle_Hz << ' ' << pause_s;
        EXPECT_EQ(counted, ends) << rate_Hz << ' ' << cycle_Hz << ' ' << pause_s;
      }
    }
  }
}

// Against the integrals over a cycle, of a motion without noise.
TEST(CycleDamping, StatesRhythmAndDriveOfEachCycle) {
  for (const double cycle_Hz : {0.65, 1.0, 1.6, 3.0}) {
    constexpr int kSteps = 1000;
    double velocity2 = 0, acceleration2 = 0, drive2 = 0;
    for (int i = 0; i < kSteps; ++i) {
      const Motion motion = two_harmonics(i / (kSteps * cycle_Hz), cycle_Hz);
      velocity2 += motion.v * motion.v;
      acceleration2 += motion.a * motion.a;
      drive2 += std::pow(drive_N(motion), 2);
    }
    auto stage = stage_at<double>(kBaseline);
    int counted = 0;
    for (double t = 0; t < 20; t += 0.005) {
      const Motion motion = two_harmonics(t, cycle_Hz);
      const auto report = take(stage, {motion.p, drive_N(motion)}, 0.005);
      if (report.outcome != CycleOutcome::counted) continue;
      ++counted;
      EXPECT_NEAR(report.rhythm_rad_s / std::sqrt(acceleration2 / velocity2), 1, 0.02);
      EXPECT_NEAR(report.drive_per_velocity_Ns_m / std::sqrt(drive2 / velocity2), 1, 0.02);
    }
    EXPECT_NEAR(counted, 20 * cycle_Hz, 2);
  }
}

// A baseline that is off by more than a minute leaves it hardly moves a cycle.
TEST(CycleDamping, HardlyNeedsTheBaselineToBeRight) {
  DrivenChewing one({}, 60, 2), other({}, 60, 2);
  auto right = stage_at<double>(kBaseline);
  auto wrong = stage_at<double>({0.03, 0.252, 20.2, 0.202});
  const auto expected = cycles_of(right, one, 60), actual = cycles_of(wrong, other, 60);
  ASSERT_EQ(actual.size(), expected.size());
  double mean = 0, squares = 0;
  const double count = static_cast<double>(actual.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const double difference = actual[i].friction_Ns_m - expected[i].friction_Ns_m;
    mean += difference / count;
    squares += std::pow(difference / expected[i].standard_deviation, 2) / count;
  }
  EXPECT_LT(std::abs(mean), 0.003);
  EXPECT_LT(std::sqrt(squares), 0.2);
}

// Far off, a value is too near to the baseline and its standard deviation says so; farther off
// there is none.
TEST(CycleDamping, SaysHowFarItCanBeTrusted) {
  auto stage = stage_at<double>(kBaseline);
  testing_support::DrivenTruth truth;
  truth.friction_Ns_m = 0.5;
  DrivenChewing chewing(truth, 60, 3);
  double mean = 0, sd = 0, count = 0;
  for (const auto& cycle : cycles_of(stage, chewing, 200)) {
    if (cycle.outcome != CycleOutcome::counted) continue;
    mean += cycle.friction_Ns_m;
    sd += cycle.standard_deviation;
    ++count;
  }
  EXPECT_GT(count, 200);
  EXPECT_LT(mean / count, 0.48);
  EXPECT_LT(0.5 - mean / count, 1.2 * sd / count);
  truth.friction_Ns_m = 2;
  chewing.become(truth);
  int counted = 0, lost = 0;
  for (const auto& cycle : cycles_of(stage, chewing, 60)) {
    counted += cycle.outcome == CycleOutcome::counted ? 1 : 0;
    lost += cycle.outcome == CycleOutcome::lost ? 1 : 0;
  }
  EXPECT_LT(counted, 5);
  EXPECT_GT(lost, 50);
}

// Half a second of wrong positions costs the cycles it is in.
TEST(CycleDamping, GoesOnAfterABurstOfWrongPositions) {
  DrivenChewing chewing({}, 60, 4);
  auto stage = stage_at<double>(kBaseline);
  int lost = 0, counted = 0;
  for (int i = 0; i < 3600; ++i) {
    DrivenSample sample = chewing.next();
    sample.position_m += 1800 <= i && i < 1830 ? 0.05 : 0;
    const auto report = take(stage, sample, 1.0 / 60);
    lost += report.outcome == CycleOutcome::lost ? 1 : 0;
    counted += report.outcome == CycleOutcome::counted ? 1 : 0;
  }
  EXPECT_GE(lost, 1);
  EXPECT_LE(lost, 4);
  EXPECT_NEAR(counted, chewing.cycles() - 2, 2);
}

TEST(CycleDamping, CyclesThatTellTooLittleDoNotCount) {
  DrivenChewing chewing({}, 60, 5);
  auto stage = stage_at<double>(kBaseline);
  int incomplete = 0, counted = 0;
  for (int i = 0; i < 3600; ++i) {
    DrivenSample sample = chewing.next();
    if (i % 6 == 0) sample.position_m = kNone;
    const auto report = take(stage, sample, 1.0 / 60);
    incomplete += report.outcome == CycleOutcome::incomplete ? 1 : 0;
    counted += report.outcome == CycleOutcome::counted ? 1 : 0;
  }
  EXPECT_EQ(counted, 0);
  EXPECT_GT(incomplete, 70);

  CycleParameters sharp;
  sharp.largest_sd_Ns_m = 0.01;
  CycleDamping<double> demanding(kBaseline, matched(), sharp);
  for (const auto& cycle : cycles_of(demanding, chewing, 30)) {
    EXPECT_EQ(cycle.outcome, CycleOutcome::uncertain);
    EXPECT_TRUE(std::isnan(cycle.friction_Ns_m));
  }
  CycleParameters slow;
  slow.longest_s = 0.5;
  CycleDamping<double> hasty(kBaseline, matched(), slow);
  for (const auto& cycle : cycles_of(hasty, chewing, 30)) {
    EXPECT_EQ(cycle.outcome, CycleOutcome::irregular);
  }
}

// The share of a cycle's positions that are missing decides, to the position.
TEST(CycleDamping, CountsTheMissingPositionsOfEachCycle) {
  CycleParameters parameters;
  parameters.share_not_taken = 0.05;
  DrivenChewing chewing({}, 60, 9);
  testing_support::Random random(9);
  CycleDamping<double> stage(kBaseline, matched(), parameters);
  std::vector<bool> is_missing;
  int at_the_limit = 0;
  for (int i = 0; i < 12000; ++i) {
    DrivenSample sample = chewing.next();
    is_missing.push_back(random.uniform() < 0.05);
    if (is_missing.back()) sample.position_m = kNone;
    const auto report = take(stage, sample, 1.0 / 60);
    if (report.outcome == CycleOutcome::none) continue;
    const auto samples = std::lround(report.duration_s * 60);
    const auto missing = std::count(is_missing.end() - samples, is_missing.end(), true);
    const bool is_incomplete = static_cast<double>(missing) > 0.05 * static_cast<double>(samples);
    EXPECT_EQ(report.outcome == CycleOutcome::incomplete, is_incomplete) << i;
    at_the_limit +=
        is_incomplete && static_cast<double>(missing) <= 0.05 * static_cast<double>(samples + 1)
            ? 1
            : 0;
  }
  EXPECT_GT(at_the_limit, 0);
}

// Ten in a row, from the first one on and after some that were right.
TEST(CycleDamping, SaysAfterTenWrongPositionsThatThePointIsLost) {
  auto stage = stage_at<double>(kBaseline);
  for (const int right : {1, 5}) {
    for (int i = 0; i < right; ++i) {
      EXPECT_EQ(stage.step(0.01, 0, 0, 5e-5).outcome, CycleOutcome::none);
    }
    for (int wrong = 1; wrong <= 10; ++wrong) {
      const auto report = stage.step(0.01, 0, 1, 5e-5);
      EXPECT_EQ(report.outcome, wrong < 10 ? CycleOutcome::none : CycleOutcome::lost) << wrong;
    }
  }
}

// By default a cycle takes a quarter of a second at least.
TEST(CycleDamping, TakesThreeCyclesASecondForChewingAndFiveNot) {
  testing_support::Random random(11);
  for (const double cycle_Hz : {3.0, 5.0}) {
    auto stage = stage_at<double>(kBaseline);
    int ends = 0;
    for (double t = 0; t < 20; t += 0.005) {
      const auto report = take(stage, with_noise(two_harmonics(t, cycle_Hz), random), 0.005);
      if (report.outcome == CycleOutcome::none) continue;
      ++ends;
      EXPECT_EQ(report.outcome, cycle_Hz < 4 ? CycleOutcome::counted : CycleOutcome::irregular);
    }
    EXPECT_NEAR(ends, 20 * cycle_Hz, 2);
  }
}

// Whatever comes, a cycle that counts has a finite value, and what comes later counts again.
TEST(CycleDamping, SurvivesNaNGapsAndNonsense) {
  testing_support::Random random(6);
  const double nonsense[] = {kNone, std::numeric_limits<double>::infinity(), 1e300, -1e300, 0, -1};
  for (unsigned seed = 1; seed <= 20; ++seed) {
    DrivenChewing chewing({}, 60, seed);
    auto stage = stage_at<double>(kBaseline);
    for (int i = 0; i < 1200; ++i) {
      DrivenSample sample = chewing.next();
      double T = 1.0 / 60;
      const double wrong = nonsense[static_cast<int>(6 * random.uniform()) % 6];
      const double which = random.uniform();
      if (which < 0.01) sample.drive_N = wrong;
      if (which > 0.01 && which < 0.02) sample.position_m = wrong;
      if (which > 0.02 && which < 0.03) T = wrong;
      const auto report = take(stage, sample, T);
      if (report.outcome == CycleOutcome::counted) {
        EXPECT_TRUE(std::isfinite(report.friction_Ns_m));
        EXPECT_GT(report.standard_deviation, 0);
      }
    }
    int counted = 0;
    for (const auto& cycle : cycles_of(stage, chewing, 20)) {
      counted += cycle.outcome == CycleOutcome::counted ? 1 : 0;
    }
    EXPECT_GT(counted, 20) << seed;
  }
}

TEST(CycleDamping, AnInterruptionDropsTheCycle) {
  DrivenChewing chewing({}, 60, 7);
  auto stage = stage_at<double>(kBaseline);
  for (int i = 0; i < 1200; ++i) {
    if (i % 30 == 0) stage.interrupt();  // less than a cycle
    EXPECT_EQ(take(stage, chewing.next(), 1.0 / 60).outcome, CycleOutcome::none);
  }
}

TEST(CycleDamping, FloatIsAsGood) {
  DrivenChewing one({}, 60, 8), other({}, 60, 8);
  auto in_double = stage_at<double>(kBaseline);
  auto in_float = stage_at<float>(kBaseline);
  const auto expected = cycles_of(in_double, one, 60);
  const auto actual = cycles_of(in_float, other, 60);
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const double sd = expected[i].standard_deviation;
    EXPECT_NEAR(static_cast<double>(actual[i].friction_Ns_m), expected[i].friction_Ns_m, 0.05 * sd);
    EXPECT_NEAR(static_cast<double>(actual[i].standard_deviation), sd, 0.02 * sd);
  }
}

}  // namespace
}  // namespace condyle
