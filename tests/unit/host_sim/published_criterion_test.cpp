// SPDX-License-Identifier: Apache-2.0
#include "tuning/published_criterion.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "condyle/estimator/published/published_cascade.h"
#include "hosted/config/parameter_file.h"
#include "hosted/files/input_error.h"
#include "support/paths.h"
#include "support/table.h"
#include "tuning/published_tuning_report.h"
#include "unit/host_sim/golden_tunings.h"

namespace condyle::host {
namespace {

using ::testing::HasSubstr;
using testing_support::golden_chewing;
using testing_support::golden_parameters;
using testing_support::tune;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// Each tuning, run afresh, is matched and has the friction it is said to have.
void expect_matched(const PublishedTuningResult& result, const PublishedRecording& recording,
                    std::size_t number = 0) {
  for (const PublishedTuning& tuning : result.tunings) {
    PublishedParameters parameters = tuning.parameters;
    parameters.sample_time_s = recording.sample_time_s;
    PublishedCascade<double> cascade(parameters);
    PublishedEstimate<double> last;
    for (const double z : recording.position_m) last = cascade.step(z);
    EXPECT_EQ(last.verdict, Verdict::matched);
    const TunedRecording& tuned = tuning.recordings[number];
    EXPECT_NEAR(last.friction_Ns_m.value, tuned.friction_Ns_m, 0.05 * tuned.friction_Ns_m);
    EXPECT_NEAR(last.mass_kg.value, tuned.mass_kg, 0.04 * tuned.mass_kg);
    EXPECT_LE(tuned.friction_range, result.plan.steady_share);
  }
}

void expect_refused(const std::vector<PublishedRecording>& recordings,
                    const PublishedTuningPlan& plan, const std::string& words) {
  try {
    (void)tune(recordings, plan);
    ADD_FAILURE() << "accepted; expected: " << words;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

// Stage 1 hardly takes a measurement, so that the mass cannot come near.
PublishedTuningPlan impossible_plan() {
  PublishedTuningPlan plan;
  plan.starts = 6;
  plan.most_evaluations = 40;
  plan.factors[0] = {1e-12, 1e-12};
  return plan;
}

TEST(PublishedCriterion, LeavesFrictionOpen) {
  for (const char* name : {"chewing_60hz", "chewing_60hz_backward", "chewing_60hz_loose_prior"}) {
    SCOPED_TRACE(name);
    const PublishedRecording recording = golden_chewing(name);
    const PublishedTuningResult result = tune({recording}, {}, golden_parameters(name));
    EXPECT_EQ(result.starts, 100U);
    EXPECT_GE(result.tunings.size(), 5U);
    EXPECT_GE(result.satisfied, result.tunings.size());
    EXPECT_GT(result.satisfied_at_once, 0U);
    EXPECT_LT(result.satisfied_at_once, result.satisfied);
    EXPECT_GE(result.evaluations, result.starts);
    EXPECT_GT(result.friction_ratio(), 3);
    EXPECT_FALSE(result.closest);
    expect_matched(result, recording);
  }
}

TEST(PublishedCriterion, LeavesFrictionOpenForTheRecordingShipped) {
  const std::string path = testing_support::source_path("/host_sim/recordings/chewing_60hz");
  const PublishedRecording recording{
      "chewing_60hz.csv", 1.0 / 60,
      testing_support::read_table(path + ".csv").numbers("position_m")};
  const PublishedTuningResult result =
      tune({recording}, {}, load_parameters(path + ".toml").values);
  EXPECT_GE(result.tunings.size(), 5U);
  EXPECT_GT(result.friction_ratio(), 3);
  expect_matched(result, recording);
}

TEST(PublishedCriterion, HandsOutDistinctTuningsWithinTheBoundsBestFirst) {
  const PublishedTuningResult result = tune({golden_chewing()});
  double previous = 0;
  for (const PublishedTuning& tuning : result.tunings) {
    EXPECT_GE(tuning.objective, previous);
    previous = tuning.objective;
    PublishedParameters parameters = tuning.parameters, base = result.base;
    for (std::size_t i = 0; i < kFreeVarianceCount; ++i) {
      const double factor = kFreeVariances[i].of(parameters) / kFreeVariances[i].of(base);
      EXPECT_GE(factor, kFreeVariances[i].factors.lowest * 0.999999);
      EXPECT_LE(factor, kFreeVariances[i].factors.highest * 1.000001);
      kFreeVariances[i].of(parameters) = kFreeVariances[i].of(base);
    }
    EXPECT_EQ(parameters.friction.initial_Ns_m, base.friction.initial_Ns_m);
    EXPECT_EQ(parameters.mass.measurement_variance[1], base.mass.measurement_variance[1]);
    for (const PublishedTuning& other : result.tunings) {
      if (&other == &tuning) continue;
      PublishedParameters a = tuning.parameters, b = other.parameters;
      EXPECT_TRUE(std::any_of(std::begin(kFreeVariances), std::end(kFreeVariances),
                              [&](const FreeVariance& free) {
                                return free.of(a) >= 2 * free.of(b) || free.of(b) >= 2 * free.of(a);
                              }));
    }
  }
  EXPECT_GT(result.at_initial_friction, 0U);
  EXPECT_LT(result.at_initial_friction, result.tunings.size());
}

TEST(PublishedCriterion, GivesTheSameForEveryNumberOfThreads) {
  const std::vector<PublishedRecording> recordings = {golden_chewing()};
  const auto one = tune(recordings, {}, golden_parameters(), 1);
  const auto two = tune(recordings, {}, golden_parameters(), 2);
  EXPECT_EQ(published_tunings_csv(one), published_tunings_csv(two));
  EXPECT_EQ(published_tuning_text(one), published_tuning_text(two));
}

TEST(PublishedCriterion, StartsElsewhereWithAnotherSeed) {
  PublishedTuningPlan plan;
  plan.starts = 60;
  const auto first = tune({golden_chewing()}, plan);
  plan.seed = 2;
  const auto second = tune({golden_chewing()}, plan);
  EXPECT_NE(published_tunings_csv(first), published_tunings_csv(second));
  EXPECT_GT(first.friction_ratio(), 3);
  EXPECT_GT(second.friction_ratio(), 3);
}

TEST(PublishedCriterion, SaysThatNoneSatisfiesIt) {
  const PublishedRecording recording = golden_chewing();
  const PublishedTuningResult result = tune({recording}, impossible_plan());
  EXPECT_EQ(result.satisfied, 0U);
  EXPECT_TRUE(result.tunings.empty());
  EXPECT_EQ(result.friction_ratio(), 1);
  ASSERT_TRUE(result.closest);
  EXPECT_FALSE(result.closest->satisfies);
  EXPECT_LE(result.evaluations, 6U * 40U);
  const std::string text = published_tuning_text(result);
  EXPECT_THAT(text, HasSubstr("NOT SATISFIED by none of 6 starts"));
  EXPECT_THAT(text, HasSubstr("closest       recording 1: not matched"));
  const std::string table = published_tunings_csv(result);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1);
  EXPECT_TRUE(draw_published_tunings("/", "none", result, recording).empty());
}

TEST(PublishedCriterion, BearsGaps) {
  PublishedRecording recording = golden_chewing();
  for (std::size_t i = 0; i < recording.position_m.size(); i += 11) {
    recording.position_m[i] = kMissing;
  }
  std::fill_n(recording.position_m.begin(), 30, kMissing);
  std::fill_n(recording.position_m.begin() + 300, 8, std::numeric_limits<double>::infinity());
  EXPECT_EQ(first_judged_sample(recording), 720U - 173U);
  const PublishedTuningResult result = tune({recording});
  EXPECT_GE(result.tunings.size(), 5U);
  EXPECT_GT(result.friction_ratio(), 3);
  expect_matched(result, recording);
}

TEST(PublishedCriterion, IsSatisfiedByEveryRecordingAtOnce) {
  const std::vector<PublishedRecording> both = {golden_chewing(),
                                                golden_chewing("chewing_60hz_backward")};
  PublishedTuningPlan plan;
  plan.starts = 40;
  const PublishedTuningResult result = tune(both, plan);
  EXPECT_GE(result.tunings.size(), 5U);
  expect_matched(result, both[0], 0);
  expect_matched(result, both[1], 1);
  const PublishedTuning& best = result.tunings.front();
  EXPECT_DOUBLE_EQ(best.objective, best.recordings[0].objective + best.recordings[1].objective);
  EXPECT_DOUBLE_EQ(best.friction_Ns_m,
                   (best.recordings[0].friction_Ns_m + best.recordings[1].friction_Ns_m) / 2);
  EXPECT_THAT(published_tunings_csv(result),
              HasSubstr(",recording_2_friction_Ns_m,recording_2_mass_kg\n"));
  EXPECT_THAT(published_tuning_text(result), HasSubstr("recording 2   chewing_60hz_backward: "));
}

TEST(PublishedCriterion, EndsWhereItIsStopped) {
  const std::vector<PublishedRecording> recordings = {golden_chewing()};
  MonteCarloControl control;
  std::atomic<std::uint64_t> seen = 0;  // asked by all threads
  control.stop = [&seen] { return seen >= 3; };
  const auto result = tune_by_published_criterion(
      recordings, golden_parameters(), {},
      [&seen](std::uint64_t merged, std::uint64_t runs) {
        seen = merged;
        EXPECT_EQ(runs, 100U);
      },
      control);
  EXPECT_EQ(result.starts, 3U);
  EXPECT_EQ(seen, 3U);
}

TEST(PublishedCriterion, RefusesWhatCannotBeTunedBy) {
  const PublishedRecording good = golden_chewing();
  expect_refused({}, {}, "no recording");
  PublishedRecording still = good;
  std::fill(still.position_m.begin(), still.position_m.end(), 0.01);
  still.position_m[5] = kMissing;
  expect_refused({good, still}, {}, "its position never changes");
  PublishedRecording missing = good;
  std::fill(missing.position_m.begin() + 39, missing.position_m.end(), kMissing);
  expect_refused({missing}, {}, "39 measured positions");
  PublishedRecording slow = good;
  slow.sample_time_s = 11;
  expect_refused({slow}, {}, "sample time of 11 s");
  PublishedTuningPlan plan;
  plan.starts = 0;
  expect_refused({good}, plan, "the number of starts");
  plan = {};
  plan.most_evaluations = 0;
  expect_refused({good}, plan, "the number of evaluations");
  plan = {};
  plan.steady_share = kMissing;
  expect_refused({good}, plan, "steady");
  for (const Range range : {Range{0, 1}, Range{2, 1}, Range{1, kMissing}}) {
    plan = {};
    plan.factors[3] = range;
    expect_refused({good}, plan, "process variance of the mass");
  }
}

TEST(MatchingCriterion, AsksNeitherForASizeNorForNoFriction) {
  PublishedParameters parameters = golden_parameters();
  parameters.friction.initial_variance[2] = parameters.friction.process_variance[2] = 0;
  const std::vector<PublishedRecording> recordings = {golden_chewing()};
  for (const double friction_Ns_m : {0.001, 0.022, 0.1}) {
    parameters.friction.initial_Ns_m = friction_Ns_m;
    const PublishedTuning tuning = judge_published_tuning(recordings, parameters, 0.05);
    EXPECT_TRUE(tuning.satisfies) << friction_Ns_m;
    EXPECT_DOUBLE_EQ(tuning.friction_Ns_m, friction_Ns_m);
    EXPECT_EQ(tuning.recordings[0].friction_range, 0);
    EXPECT_DOUBLE_EQ(tuning.objective, tuning.recordings[0].mass_deviation);
  }
}

TEST(MatchingCriterion, TakesNoNegativeFriction) {
  PublishedParameters parameters = golden_parameters();
  const std::vector<PublishedRecording> recordings = {golden_chewing()};
  parameters.friction.initial_variance[2] = parameters.friction.process_variance[2] = 0;
  parameters.friction.initial_Ns_m = 0;
  EXPECT_FALSE(judge_published_tuning(recordings, parameters, 0.05).satisfies);

  // A swing that dies down, and a tuning that makes a steady friction below zero of it.
  PublishedRecording swing{"swing", 1.0 / 60, {}};
  for (int i = 0; i < 720; ++i) {
    const double t = i / 60.0;
    swing.position_m.push_back(1e-3 * std::exp(0.3 * (6 - t)) * std::sin(8 * t));
  }
  parameters = {};
  parameters.motion.process_variance[2] *= 72;
  parameters.motion.measurement_variance[0] *= 0.0203;
  parameters.friction.initial_variance[2] *= 5.4e7;
  for (double& variance : parameters.friction.measurement_variance) variance *= 0.036;
  parameters.mass.process_variance[2] *= 0.03;
  parameters.mass.measurement_variance[1] *= 10;
  const PublishedTuning tuning = judge_published_tuning({&swing, 1}, parameters, 0.05);
  EXPECT_EQ(tuning.recordings[0].verdict, Verdict::matched);
  EXPECT_LT(tuning.recordings[0].friction_range, 0.05);
  EXPECT_LT(tuning.friction_Ns_m, 0);
  EXPECT_FALSE(tuning.satisfies);
}

TEST(MatchingCriterion, WantsSteadyFriction) {
  PublishedParameters parameters = golden_parameters();
  parameters.friction.initial_variance[2] = 1e-6;
  const std::vector<PublishedRecording> recordings = {golden_chewing()};
  const PublishedTuning tuning = judge_published_tuning(recordings, parameters, 10);
  ASSERT_TRUE(tuning.satisfies);
  const double range = tuning.recordings[0].friction_range;
  EXPECT_GT(range, 0.001);
  EXPECT_TRUE(judge_published_tuning(recordings, parameters, 1.001 * range).satisfies);
  EXPECT_FALSE(judge_published_tuning(recordings, parameters, 0.999 * range).satisfies);
}

TEST(MatchingCriterion, CountsDivergence) {
  PublishedParameters parameters = golden_parameters();
  parameters.mass.process_variance[2] = 10;  // the mass turns negative
  const std::vector<PublishedRecording> recordings = {golden_chewing()};
  const PublishedTuning tuning = judge_published_tuning(recordings, parameters, 1e9);
  EXPECT_EQ(tuning.recordings[0].verdict, Verdict::diverged);
  EXPECT_FALSE(tuning.satisfies);
  EXPECT_GE(tuning.objective, 10);
  EXPECT_LE(tuning.objective, 30);
}

}  // namespace
}  // namespace condyle::host
