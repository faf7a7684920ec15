// SPDX-License-Identifier: Apache-2.0
// Readings of chewing: shape, side and scatter of cycles, and the average cycle.
#include <gmock/gmock.h>

#include <cmath>

#include "hosted/files/input_error.h"
#include "readings/chewing_summary.h"
#include "readings/simulated_readings.h"
#include "simulation/kinematic/true_cycles.h"
#include "statistics/random.h"
#include "support/acceptance.h"
#include "support/tier.h"

namespace condyle::host {
namespace {

JawScenario chewing(std::uint64_t motion_seed) {
  JawScenario scenario;
  scenario.motion_seed = motion_seed;
  scenario.tasks = {default_task(JawTaskKind::rest), default_task(JawTaskKind::chewing)};
  scenario.tasks[1].duration_s = 30;
  scenario.tasks[1].chewing.alternates = true;
  scenario.tasks[1].chewing.reversed_share = 0.2;
  scenario.facebow.rate_Hz = 100;
  scenario.landmarks = {1, 1, 1};
  return scenario;
}

// Errors of the readings on exact poses, steps of `step_s` apart, of cycles that others precede and
// follow at once: of each reading one for each cycle, relative to its size where that exceeds 1.
std::map<std::string, std::vector<double>> errors_on_exact_poses(const KinematicJaw& jaw,
                                                                 double step_s) {
  const auto cycles = true_cycles(jaw);
  const TruthOfCycles truth(jaw, cycles);
  const auto names = readings_of_cycle(true);
  std::map<std::string, std::vector<double>> errors;
  for (std::size_t i = 1; i + 1 < cycles.size(); ++i) {
    if (cycles[i - 1].sequence != cycles[i + 1].sequence) continue;
    const JawPath path = exact_path(jaw, cycles[i].begin_s - 0.2, cycles[i].end_s + 0.2, step_s);
    const auto sample_at = [&](double time_s) {
      return static_cast<std::size_t>(std::lround((time_s - path.time_s[0]) / step_s));
    };
    ChewingCycle cycle;
    cycle.begin = sample_at(cycles[i].begin_s);
    cycle.turn = sample_at(cycles[i].opening_end_s);
    cycle.end = sample_at(cycles[i].end_s);
    cycle.begin_s = cycles[i].begin_s;
    std::vector<double> values;
    constexpr double kNoReach_s = 1e-9;
    const GreatestAt greatest(path.time_s, kNoReach_s);
    read_cycle(cycle, 0, 1e-6, true, path, greatest, values, nullptr);
    for (const TrueCycleValue& expected : truth.cycles()[i].values) {
      const auto name = std::find(names.begin(), names.end(), expected.reading);
      EXPECT_NE(name, names.end()) << expected.reading;
      if (name == names.end()) continue;
      const double value = values[static_cast<std::size_t>(name - names.begin())];
      errors[expected.reading].push_back((value - expected.value) /
                                         std::max(1.0, std::abs(expected.value)));
    }
  }
  return errors;
}

// The formulas on exact poses at 2 kHz. Larger than 1e-6, because the jerk of the motion has a step
// at every closed and most open instant, and one within each cycle:
//   times, and sparc between them   a parabola or line through samples on both sides of a step:
//                                   second order
//   path                            ends at the samples nearest to the closed instants: second
//   order ldlj                            differences across a step: first order
TEST(CycleReadings, EqualTheTruthOnExactPoses) {
  const KinematicJaw jaw(chewing(3));
  const auto all = errors_on_exact_poses(jaw, 0.0005);
  EXPECT_EQ(all.size(), 20U);
  for (const auto& [reading, errors] : all) {
    const bool is_time = reading.ends_with("_s") && !reading.ends_with("_mm_s");
    const double tolerance = is_time || reading.ends_with("sparc") || reading == "cycle_path_mm"
                                 ? 2e-6
                             : reading.ends_with("ldlj") ? 6e-5
                                                         : 1e-6;
    EXPECT_GT(errors.size(), 5U) << reading;
    for (const double error : errors) EXPECT_NEAR(error, 0, tolerance) << reading;
  }
}

TEST(CycleReadings, ConvergeToTheTruthWithTheRate) {
  const KinematicJaw jaw(chewing(3));
  const auto rms = [](const std::vector<double>& errors) {
    double squares = 0;
    for (const double error : errors) squares += error * error;
    return std::sqrt(squares / static_cast<double>(errors.size()));
  };
  auto slow = errors_on_exact_poses(jaw, 0.002), fast = errors_on_exact_poses(jaw, 0.00025);
  // Eight times finer: 64 times less at second order. Where samples lie decides a factor of two.
  for (const char* reading :
       {"cycle_duration_s", "opening_time_s", "closing_time_s", "cycle_path_mm"}) {
    EXPECT_GT(rms(slow[reading]), 32 * rms(fast[reading])) << reading;
  }
}

TEST(TrueCycles, CloseToTheWorkingSide) {
  const KinematicJaw jaw(chewing(5));
  const auto cycles = true_cycles(jaw);
  const TruthOfCycles truth(jaw, cycles);
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    if (cycles[i].is_reversed) continue;
    EXPECT_EQ(truth.cycles()[i].side, cycles[i].working);
    EXPECT_FALSE(truth.cycles()[i].is_reversed);
  }
}

Analysis analyse_simulation(const KinematicSimulation& simulation, const LandmarkErrors& errors,
                            Side side = Side::none) {
  SampleRecording recording(simulation.samples());
  AnalysisChoice choice;
  choice.tasks = stated_tasks(simulation);
  for (Task& task : choice.tasks) {
    if (task.kind == TaskKind::chewing) task.side = side;
  }
  return analyse(recording, "simulation", stated_landmarks(simulation, errors), choice);
}

TEST(CycleSides, AreThoseOfTheClosingPathAndAStatedSidePrecedes) {
  const JawScenario scenario = chewing(7);
  const KinematicSimulation simulation(scenario, 1);
  const auto cycles = true_cycles(simulation.jaw());
  const TruthOfCycles truth(simulation.jaw(), cycles);
  const Analysis found = analyse_simulation(simulation, scenario.landmarks);
  ASSERT_EQ(found.cycles.size(), cycles.size());
  int clear = 0;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    if (cycles[i].is_reversed) continue;  // those may close in the midline
    ++clear;
    EXPECT_EQ(found.cycles[i].side, jaw_side_name(cycles[i].working)) << i;
    EXPECT_FALSE(found.cycles[i].is_side_stated);
  }
  EXPECT_GT(clear, 10);
  const Analysis stated = analyse_simulation(simulation, scenario.landmarks, Side::left);
  for (const AnalysedCycle& cycle : stated.cycles) {
    EXPECT_EQ(cycle.side, "left");
    EXPECT_TRUE(cycle.is_side_stated);
  }
  EXPECT_THAT(stated.notes, testing::Contains(testing::HasSubstr("chewing stated left: of ")));
}

TEST(CycleSides, AreTakenFromTheNameOfATask) {
  const auto tasks = tasks_of_words({"chewing-right", "1", "2", "chewing", "3", "4"});
  EXPECT_EQ(tasks[0].kind, TaskKind::chewing);
  EXPECT_EQ(tasks[0].side, Side::right);
  EXPECT_EQ(tasks[1].side, Side::none);
  EXPECT_THROW(tasks_of_words({"opening-left", "1", "2"}), InputError);
}

// Cycles whose durations are `numbers`, each with the same noise, on sides y.
Analysis with_durations(const std::vector<double>& numbers, double noise_sd,
                        const std::vector<double>& sides_mm = {}) {
  Analysis analysis;
  analysis.has_landmarks = true;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    AnalysedCycle cycle;
    cycle.number = static_cast<int>(i + 1);
    cycle.values.resize(readings_of_cycle(true).size());
    cycle.values[0].value = numbers[i];
    cycle.values[0].noise_sd = noise_sd;
    cycle.directions.closing_side_mm.value = i < sides_mm.size() ? sides_mm[i] : 0;
    cycle.directions.frontal_area_mm2.value = 10 * cycle.directions.closing_side_mm.value;
    cycle.directions.closing_side_mm.noise_sd = 0.05;
    analysis.cycles.push_back(std::move(cycle));
  }
  find_sides(analysis);
  return analysis;
}

const CycleSummary& named(const std::vector<CycleSummary>& all, std::string_view name,
                          Side side = Side::none) {
  return *std::find_if(all.begin(), all.end(), [&](const CycleSummary& one) {
    return one.name == name && one.side == side;
  });
}

// Scatter s = 0.05 s with noise of 0, s/2 and s. The mean of 400 variances of 20 cycles misses s^2
// by more than 5 of its standard deviations with a probability below 1e-6.
TEST(CycleScatter, IsWithoutThatOfTheMeasurement) {
  RandomGenerator random(11);
  constexpr int kRuns = 400, kCycles = 20;
  constexpr double kScatter = 0.05;
  for (const double noise : {0.0, 0.025, 0.05}) {
    double sum = 0;
    for (int run = 0; run < kRuns; ++run) {
      std::vector<double> numbers;
      for (int i = 0; i < kCycles; ++i) {
        numbers.push_back(0.8 + kScatter * random.normal() + noise * random.normal());
      }
      const auto all = summaries_of(with_durations(numbers, noise));
      const CycleSummary& sd = named(all, "cycle_duration_sd_s");
      sum += sd.value.value * sd.value.value / kRuns;
      EXPECT_LE(sd.interval->front(), sd.value.value);
      EXPECT_GE(sd.interval->back(), sd.value.value);
      EXPECT_EQ(sd.value.value == 0, !sd.remark.empty());
    }
    const double variance = kScatter * kScatter + noise * noise;
    const double sd_of_mean = variance * std::sqrt(2.0 / (kCycles - 1) / kRuns);
    EXPECT_NEAR(sum, kScatter * kScatter, 5 * sd_of_mean) << noise;
  }
}

TEST(CycleScatter, OfEqualCyclesIsZeroAndSaysSo) {
  RandomGenerator random(13);
  int zeros = 0;
  for (int run = 0; run < 100; ++run) {
    std::vector<double> numbers;
    for (int i = 0; i < 12; ++i) numbers.push_back(0.8 + 0.01 * random.normal());
    const auto all = summaries_of(with_durations(numbers, 0.01));
    const CycleSummary& sd = named(all, "cycle_duration_sd_s");
    zeros += sd.value.value == 0;
    EXPECT_GE(sd.interval->front(), 0);
  }
  // Half of them; fewer than 25 of 100 with a probability of 1e-6.
  EXPECT_GT(zeros, 25);
}

TEST(Laterality, HasWilsonsInterval) {
  std::vector<double> sides(10, -3);
  sides[0] = sides[1] = 3;
  const auto all = summaries_of(with_durations(std::vector<double>(10, 0.8), 0.01, sides));
  const CycleSummary& index = named(all, "laterality_index");
  EXPECT_NEAR(index.value.value, 0.6, 1e-12);
  // Of 8 of 10: 0.4902 to 0.9433.
  EXPECT_NEAR(index.interval->front(), 2 * 0.4902 - 1, 2e-4);
  EXPECT_NEAR(index.interval->back(), 2 * 0.9433 - 1, 2e-4);
  EXPECT_EQ(named(all, "side_cycle_count", Side::left).value.value, 2);
  EXPECT_EQ(named(all, "side_cycle_count", Side::right).value.value, 8);
  EXPECT_EQ(named(all, "midline_cycle_count").value.value, 0);
  EXPECT_EQ(named(all, "reversed_loop_count").value.value, 0);
}

TEST(Laterality, CountsHaveTheCyclesNearTheLimitInTheirInterval) {
  const auto all =
      summaries_of(with_durations(std::vector<double>(4, 0.8), 0.01, {3, 1.05, 0.95, -3}));
  const CycleSummary& left = named(all, "side_cycle_count", Side::left);
  EXPECT_EQ(left.value.value, 2);
  EXPECT_EQ(left.interval->front(), 1);
  EXPECT_EQ(left.interval->back(), 3);
}

// The mean of the cycles that a subject would make lies in the band: 95 % of the points over
// sessions of new cycles, noise and landmarks. Points of one session move together, so the bound is
// that of the sessions: of 12 fewer than 80 % are covered with a probability of 2 %, of 20 with
// 0.3 %, of 200 with less than 1e-12.
TEST(AverageCycles, HaveABandThatContainsTheMeanOfManyCycles) {
  const int runs = testing_support::runs(12, 20, 200);
  constexpr int kPoints = 2 * AverageCycle::kHalf;
  std::vector<std::vector<AverageCycle>> found;
  std::map<std::string, std::vector<Eigen::Vector3d>> sums;
  std::map<std::string, double> counts;
  for (int run = 0; run < runs; ++run) {
    const JawScenario scenario = chewing(static_cast<std::uint64_t>(100 + run));
    const KinematicSimulation simulation(scenario, static_cast<std::uint64_t>(run));
    found.push_back(analyse_simulation(simulation, scenario.landmarks).average_cycles);
    const KinematicJaw& jaw = simulation.jaw();
    for (const JawCycle& cycle : true_cycles(jaw)) {
      auto& sum = sums["all"];
      sum.resize(kPoints, Eigen::Vector3d::Zero());
      ++counts["all"];
      for (int i = 0; i < kPoints; ++i) {
        const double share = (i % AverageCycle::kHalf) / (AverageCycle::kHalf - 1.0);
        const double time_s =
            i < AverageCycle::kHalf
                ? cycle.begin_s + share * (cycle.opening_end_s - cycle.begin_s)
                : cycle.opening_end_s + share * (cycle.end_s - cycle.opening_end_s);
        const JawPose pose = jaw.pose_at(time_s);
        const Eigen::Vector3d& point_m = jaw.landmarks().incisor_lower;
        sum[static_cast<std::size_t>(i)] +=
            1e3 * (pose.rotation * point_m + pose.translation_m - point_m);
      }
    }
  }
  int points = 0, covered = 0;
  for (const auto& averages : found) {
    ASSERT_FALSE(averages.empty());
    const AverageCycle& average = averages[0];
    ASSERT_EQ(average.side, "all");
    ASSERT_EQ(average.withheld, "");
    ASSERT_EQ(average.points.size(), static_cast<std::size_t>(kPoints));
    for (std::size_t i = 0; i < average.points.size(); ++i) {
      const Eigen::Vector3d truth = sums["all"][i] / counts["all"];
      for (int axis = 0; axis < 3; ++axis) {
        ++points;
        covered += std::abs(average.points[i].mean_mm[axis] - truth[axis]) <=
                   average.points[i].half_interval_mm[axis];
      }
    }
  }
  std::printf("average cycle: %.1f %% of %d coordinates in the band\n", 100.0 * covered / points,
              points);
  EXPECT_GE(covered, 0.8 * points);
}

TEST(AverageCycles, AreWithheldOfFewCycles) {
  JawScenario scenario = chewing(1);
  scenario.tasks[1].duration_s = 3.5;
  const KinematicSimulation simulation(scenario, 1);
  const Analysis analysis = analyse_simulation(simulation, scenario.landmarks);
  ASSERT_FALSE(analysis.average_cycles.empty());
  for (const AverageCycle& average : analysis.average_cycles) {
    EXPECT_TRUE(average.points.empty());
    EXPECT_THAT(average.withheld, testing::HasSubstr("at least 5 are needed"));
  }
}

}  // namespace
}  // namespace condyle::host
