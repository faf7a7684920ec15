// SPDX-License-Identifier: Apache-2.0
#include "evaluation/estimator_evaluation.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

#include "simulation/scenario_file.h"
#include "support/paths.h"

namespace condyle::host {
namespace {

Scenario scenario(const std::string& name, double duration_s) {
  Scenario scenario =
      load_scenario(testing_support::source_path("/host_sim/scenarios/") + name + ".toml");
  scenario.duration_s = duration_s;
  return scenario;
}

double rms_of(const Evaluation& evaluation, EvaluatedIndex quantity) {
  return evaluation.errors[quantity].report(0.99).rms;
}

const EstimatorSettings kBoth[] = {RecommendedSettings{{}, 4}, PublishedParameters{}};

TEST(EstimatorEvaluation, DoesNotDependOnTheNumberOfThreads) {
  for (const EstimatorSettings& settings : kBoth) {
    const auto evaluate = [&](unsigned threads) {
      return evaluate_estimator(scenario("point_mass", 5), settings, {.runs = 5}, {},
                                {.threads = threads});
    };
    const Evaluation one = evaluate(1), three = evaluate(3);
    EXPECT_EQ(rms_of(one, kVelocityError), rms_of(three, kVelocityError));
    EXPECT_EQ(one.innovations[0].correlation.mean(), three.innovations[0].correlation.mean());
    EXPECT_EQ(one.samples, 5U * 300U) << "also those that waited at the end";
  }
}

TEST(EstimatorEvaluation, ProgressMovesWithinARun) {
  for (const EstimatorSettings& settings : kBoth) {
    std::vector<double> shares;
    MonteCarloControl control;
    control.threads = 1;
    std::atomic<bool> has_moved = false;
    control.stop = [&] { return has_moved.load(); };
    evaluate_estimator(
        scenario("chewing", 3600), settings, {.runs = 2},
        [&](double share) {
          shares.push_back(share);
          has_moved = shares.front() < share;
        },
        control);
    ASSERT_GE(shares.size(), 2U);
    EXPECT_GT(shares[0], 0);
    EXPECT_GT(shares[1], shares[0]);
    EXPECT_LT(shares[1], 0.5) << "before the first of two runs has ended";
  }
}

TEST(EstimatorEvaluation, CountsWhatHappens) {
  for (const EstimatorSettings& settings : kBoth) {
    Scenario lossy = scenario("point_mass", 20);
    lossy.facebow.lost_share = 0.05;
    lossy.facebow.repeated_share = 0.05;
    const Evaluation evaluation = evaluate_estimator(lossy, settings, {.runs = 3});
    const double gaps = static_cast<double>(evaluation.events[Event::time_gap]);
    const double repeats = static_cast<double>(evaluation.events[Event::time_repeated]);
    EXPECT_NEAR(gaps, 0.05 * 3600, 60);
    EXPECT_NEAR(repeats, 0.05 * 3600, 60);
    const bool is_recommended = std::holds_alternative<RecommendedSettings>(settings);
    EXPECT_EQ(evaluation.not_computed[kPositionError] > 0, is_recommended)
        << "a measurement told twice is one";
  }
}

TEST(EstimatorEvaluation, OneAxisAloneHasOneInnovation) {
  Scenario alone = scenario("point_mass", 5);
  alone.facebow.gives_points = false;
  for (const EstimatorSettings& settings : kBoth) {
    const Evaluation evaluation = evaluate_estimator(alone, settings, {.runs = 2});
    EXPECT_EQ(evaluation.innovation_axes, 1);
    EXPECT_LT(rms_of(evaluation, kPositionError), 2e-4);
  }
}

TEST(ErrorOverTime, IsRootMeanSquareByStretch) {
  ErrorOverTime first(150), second(150), all;
  first.add(0.5, 3, 1);
  second.add(0.6, -4, 7);
  second.add(149.5, 2, 1);
  second.add(20, std::nan(""), 1);
  second.add(-1, 100, 1);
  all.merge(first);
  all.merge(second);
  const auto stretches = all.stretches();
  ASSERT_EQ(stretches.size(), 2U);
  EXPECT_DOUBLE_EQ(stretches[0].middle_s, 0.5);
  EXPECT_DOUBLE_EQ(stretches[0].error_rms, std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(stretches[0].claimed_rms, 5);
  EXPECT_DOUBLE_EQ(stretches[1].middle_s, 149.5);
}

}  // namespace
}  // namespace condyle::host
