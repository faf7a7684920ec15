// SPDX-License-Identifier: Apache-2.0
// Greatest speeds, whatever the time of a stroke, the rate and the noise.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "readings/burst_search.h"
#include "readings/peak_speed.h"
#include "readings/reading_geometry.h"
#include "readings/simulated_readings.h"
#include "statistics/random.h"
#include "support/acceptance.h"
#include "support/tier.h"

namespace condyle::host {
namespace {

constexpr double kTimes_s[] = {0.08, 0.15, 0.3, 0.6, 1.5, 3};
constexpr double kNoises_m[] = {1e-6, 2e-5, 1e-4, 3e-4};

double least_jerk(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10 + x * (-15 + 6 * x));
}

// Ways from 0 to 1 in the time 1, with speeds of different form.
constexpr int kShapes = 5;
double way(int shape, double x) {
  const double within = std::clamp(x, 0.0, 1.0);
  switch (shape) {
    case 0:
      return least_jerk(x);
    case 1:  // fast at first
      return least_jerk(std::pow(within, 1.4));
    case 2:  // a normal distribution
      return (1 + std::erf(4.2 * (x - 0.5))) / 2;
    case 3:  // two movements, one after the other
      return 0.6 * least_jerk(x / 0.7) + 0.4 * least_jerk((x - 0.35) / 0.65);
    default:  // begins and ends with a jump of the acceleration
      return (1 - std::cos(std::numbers::pi * within)) / 2;
  }
}

struct Score {
  int all = 0, shown = 0, covered = 0;
  void add(const UncertainValue& value, double truth) {
    ++all;
    const JawReading reading = judged(definition_of("opening_peak_speed_mm_s"), value, "strokes");
    if (reading.provenance == ReadingProvenance::withheld) return;
    ++shown;
    covered += reading.low <= truth && truth <= reading.high;
  }
  void add(const Score& other) {
    all += other.all;
    shown += other.shown;
    covered += other.covered;
  }
};

// One stroke on an arc, of `time_s`, as a motion without turning. `click_s`: on its way the jaw
// clicks 1 mm to the side in that time; 0: it does not.
void add_stroke(int shape, double time_s, double rate_Hz, double noise_m, double click_s,
                RandomGenerator& random, Score& score) {
  constexpr double kArc_m = 0.1, kLength_m = 0.04, kRest_s = 0.5;
  const double begin_s = kRest_s + random.uniform() / rate_Hz;
  const double way_s = time_s * (1 + 0.1 * random.uniform());
  const double length_m = kLength_m * (1 + 0.1 * random.uniform());
  const double clicks_s = begin_s + (0.2 + 0.6 * random.uniform()) * way_s;
  const auto place = [&](double at_s) -> Eigen::Vector3d {
    const double angle = length_m / kArc_m * way(shape, (at_s - begin_s) / way_s);
    const double aside_m = click_s > 0 ? 1e-3 * least_jerk((at_s - clicks_s) / click_s) : 0;
    return {kArc_m * (std::cos(angle) - 1), 0.1 * kArc_m * angle + aside_m,
            -kArc_m * std::sin(angle)};
  };
  ReferredMotion motion;
  for (int k = 0; k / rate_Hz < begin_s + way_s + kRest_s; ++k) {
    Vector6 sample = Vector6::Zero();
    sample.head<3>() = place(k / rate_Hz);
    for (int i = 0; i < 3; ++i) sample[i] += noise_m * random.normal();
    motion.time_s.push_back(k / rate_Hz);
    motion.motion.push_back(sample);
  }
  double truth_mm_s = 0;
  for (double at_s = begin_s; at_s < begin_s + way_s; at_s += way_s / 1000) {
    constexpr double h_s = 1e-5;
    truth_mm_s =
        std::max(truth_mm_s, 1e3 * (place(at_s + h_s) - place(at_s - h_s)).norm() / (2 * h_s));
  }
  PoseNoise noise;
  noise.root.topLeftCorner<3, 3>() = noise_m * Eigen::Matrix3d::Identity();
  noise.covariance = noise.root * noise.root.transpose();
  const SharedErrors errors;
  const SampleRun all{0, motion.time_s.size()};
  SpeedReader reader(motion, all, noise, errors, PathPart::incisor);
  score.add(reader.greatest(SpeedPoint::incisor, all, 0), truth_mm_s);
}

// The form, the time of a stroke, the rate and the noise vary far beyond those of jaws.
TEST(PeakSpeed, IsInItsIntervalOrWithheld) {
  const int runs = testing_support::runs(4, 8, 400);
  Score whole;
  for (int shape = 0; shape < kShapes; ++shape) {
    for (const double time_s : kTimes_s) {
      Score of_time;
      for (const double rate_Hz : {60.0, 100.0, 240.0, 500.0}) {
        for (const double noise_m : kNoises_m) {
          RandomGenerator random(31, static_cast<std::uint64_t>(shape));
          Score score;
          for (int run = 0; run < runs; ++run) {
            add_stroke(shape, time_s, rate_Hz, noise_m, 0, random, score);
          }
          of_time.add(score);
          if (score.covered < 0.9 * score.shown) {
            std::printf(
                "form %d, %.2f s at %.0f Hz, %.0f um: %d of %d shown, %d of these covered\n", shape,
                time_s, rate_Hz, 1e6 * noise_m, score.shown, score.all, score.covered);
          }
          // Of 480 such cells one fails with a probability of 5 % if 85 % are covered; where few
          // are shown, they are those whose interval is too short by chance.
          EXPECT_GE(
              static_cast<std::uint64_t>(score.covered),
              testing_support::fewest_hits(static_cast<std::uint64_t>(score.shown), 0.85, 1e-4));
        }
      }
      whole.add(of_time);
      std::printf("form %d, %.2f s: %4.1f %% shown, %5.1f %% of these covered\n", shape, time_s,
                  100.0 * of_time.shown / of_time.all, 100.0 * of_time.covered / of_time.shown);
      EXPECT_GE(
          static_cast<std::uint64_t>(of_time.covered),
          testing_support::fewest_hits(static_cast<std::uint64_t>(of_time.shown), 0.92, 1e-4));
      EXPECT_GE(static_cast<std::uint64_t>(of_time.shown),
                testing_support::fewest_hits(static_cast<std::uint64_t>(of_time.all),
                                             time_s < 0.1   ? 0.1
                                             : time_s < 0.2 ? 0.2
                                                            : 0.7,
                                             1e-4));
    }
  }
  std::printf("all: %.1f %% shown, %.1f %% of these covered\n", 100.0 * whole.shown / whole.all,
              100.0 * whole.covered / whole.shown);
}

// A window that is wide enough for the stroke would pass over it.
TEST(PeakSpeed, IncludesAClickThatNoiseDoesNotHide) {
  const int runs = testing_support::runs(15, 30, 400);
  for (const double click_s : {0.02, 0.04, 0.08}) {
    for (const double rate_Hz : {200.0, 500.0}) {
      for (const double noise_m : {1e-6, 2e-5, 5e-5}) {
        RandomGenerator random(32);
        Score score;
        for (int run = 0; run < runs; ++run) {
          for (const double time_s : {0.6, 1.5}) {
            add_stroke(0, time_s, rate_Hz, noise_m, click_s, random, score);
          }
        }
        std::printf("%.2f s at %.0f Hz, %.0f um: %d of %d shown, %d of these covered\n", click_s,
                    rate_Hz, 1e6 * noise_m, score.shown, score.all, score.covered);
        // The speed of a click within a few samples, or in more noise, cannot be read.
        const double shown = click_s < 0.03 ? 0 : noise_m < 4e-5 ? 0.7 : 0.15;
        EXPECT_GE(static_cast<std::uint64_t>(score.shown),
                  testing_support::fewest_hits(static_cast<std::uint64_t>(score.all), shown, 1e-4));
        // Of the 18 cells one fails with a probability of 0.2 % if 90 % are covered.
        EXPECT_GE(static_cast<std::uint64_t>(score.covered),
                  testing_support::fewest_hits(static_cast<std::uint64_t>(score.shown), 0.9, 1e-4));
      }
    }
  }
}

// The same of a whole analysis: openings of a jaw, their speeds on the way out and back, those of
// the condyles, and those of the cycles of chewing that is as fast.
struct JawCell {
  double stroke_s, rate_Hz, noise_m;
};

JawScenario fast_session(const JawCell& cell) {
  JawScenario scenario;
  for (const JawTaskKind kind : {JawTaskKind::rest, JawTaskKind::opening, JawTaskKind::chewing}) {
    scenario.tasks.push_back(default_task(kind));
  }
  scenario.tasks[0].duration_s = 2;
  JawTask& opening = scenario.tasks[1];
  opening.stroke_s = cell.stroke_s;
  opening.hold_s = 0.05;
  JawTask& chewing = scenario.tasks[2];
  chewing.chewing.cycle_s = std::clamp(2 * cell.stroke_s, 0.35, 2.0);
  chewing.duration_s = 8 * chewing.chewing.cycle_s;
  chewing.chewing.swallows = false;
  chewing.chewing.speech_s = 0;
  scenario.facebow.rate_Hz = cell.rate_Hz;
  scenario.facebow.noise_m = cell.noise_m;
  scenario.facebow.noise_rad = cell.noise_m / 0.05;
  scenario.landmarks = {1, 1, 1};
  return scenario;
}

TEST(SpeedReadings, ContainTheTruthOrAreWithheld) {
  const int runs = testing_support::runs(1, 1, 60);
  const int stride = testing_support::runs(5, 2, 1);  // the shorter forms take one cell of these
  int cell = 0;
  std::map<std::string, Coverage> whole;
  for (const double stroke_s : kTimes_s) {
    Coverage of_time;
    const auto jaw = std::make_shared<const KinematicJaw>(fast_session({stroke_s, 200, 0}));
    const auto truth = true_readings(*jaw);  // whatever the instrument
    for (const double rate_Hz : {60.0, 200.0, 500.0}) {
      for (const double noise_m : kNoises_m) {
        if (cell++ % stride != 0) continue;
        const JawScenario scenario = fast_session({stroke_s, rate_Hz, noise_m});
        for (int run = 0; run < runs; ++run) {
          const KinematicSimulation simulation(jaw, scenario,
                                               300 + static_cast<std::uint64_t>(run));
          SampleRecording recording(simulation.samples());
          AnalysisChoice choice;
          choice.tasks = stated_tasks(simulation);
          const Analysis analysis = analyse(
              recording, "simulation", stated_landmarks(simulation, scenario.landmarks), choice);
          Coverages coverages;
          compare_means(analysis, truth, coverages);
          for (const auto& [key, one] : coverages) {
            if (!key.ends_with("speed_mm_s")) continue;
            for (Coverage* const sum : {&of_time, &whole[key]}) {
              sum->wanted += one.wanted;
              sum->shown += one.shown;
              sum->covered += one.covered;
            }
            if (one.covered < one.shown) {
              std::printf("not covered: %s, %.2f s at %.0f Hz, %.0f um: off by %.2f, half %.2f\n",
                          key.c_str(), stroke_s, rate_Hz, 1e6 * noise_m, one.sum, one.halves);
            }
          }
        }
      }
    }
    std::printf("strokes of %.2f s: %d of %d shown, %.1f %% of these covered\n", stroke_s,
                of_time.shown, of_time.wanted, 100.0 * of_time.covered / of_time.shown);
    // A true 92 % would fail with a probability of 1e-4, if readings did not share landmarks.
    EXPECT_GE(static_cast<std::uint64_t>(of_time.covered),
              testing_support::fewest_hits(static_cast<std::uint64_t>(of_time.shown), 0.92, 1e-4));
  }
  for (const auto& [key, one] : whole) {
    std::printf("%s: %d of %d shown, %.1f %% of these covered\n", key.c_str(), one.shown,
                one.wanted, 100.0 * one.covered / one.shown);
    EXPECT_GE(static_cast<std::uint64_t>(one.covered),
              testing_support::fewest_hits(static_cast<std::uint64_t>(one.shown), 0.92, 1e-4));
  }
}

// A movement out and back within 0.2 s is kept; a jump out and back as long is not.
TEST(Bursts, AreNotFastMovements) {
  for (const double rate_Hz : {100.0, 200.0, 500.0}) {
    std::vector<double> time_s;
    std::vector<Vector6> moves, jumps;
    for (int k = 0; k < rate_Hz; ++k) {
      time_s.push_back(k / rate_Hz);
      Vector6 place = Vector6::Zero();
      place[0] = 0.04 * (least_jerk((time_s.back() - 0.4) / 0.09) -
                         least_jerk((time_s.back() - 0.5) / 0.09));
      moves.push_back(place);
      place[0] = std::abs(time_s.back() - 0.5) < 0.08 ? 0.04 : 0;
      jumps.push_back(place);
    }
    EXPECT_TRUE(find_bursts(time_s, moves).empty()) << rate_Hz;
    ASSERT_EQ(find_bursts(time_s, jumps).size(), 1U) << rate_Hz;
  }
}

}  // namespace
}  // namespace condyle::host
