// SPDX-License-Identifier: Apache-2.0
#include "condyle/firmware/run_loop.h"

#include <gtest/gtest.h>

#include <vector>

#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/hal/clock.h"

namespace condyle::firmware {
namespace {

using hal::Status;
using Estimate = PublishedEstimate<double>;

// Gives what it is told to, in order; then it is at its end.
class ScriptedFacebow final : public hal::Facebow {
 public:
  struct Step {
    Status status;
    Sample sample;
  };
  explicit ScriptedFacebow(std::vector<Step> steps) : steps_(std::move(steps)) {}
  Status open() override {
    ++openings;
    return openings % 3 == 0 ? Status::ok : Status::not_found;  // takes a while to come back
  }
  Status read(TimeNs deadline_ns, Sample& sample) override {
    deadlines.push_back(deadline_ns);
    if (next_ == steps_.size()) return Status::end;
    sample = steps_[next_].sample;
    return steps_[next_++].status;
  }
  void close() override {}
  std::vector<TimeNs> deadlines;
  int openings = 0;

 private:
  std::vector<Step> steps_;
  std::size_t next_ = 0;
};

Sample at(double time_s, double position_m) {
  Sample sample;
  sample.time_ns = nanoseconds(time_s);
  sample.coordinates[0] = position_m;
  return sample;
}

struct Outcome {
  Status status;
  RunCounts counts;
  std::vector<Estimate> estimates;
};

Outcome run_script(std::vector<ScriptedFacebow::Step> steps) {
  ScriptedFacebow facebow(std::move(steps));
  hal::ManualClock clock;
  PublishedParameters parameters;
  parameters.sample_time_s = 0.02;
  PublishedSensor<double> sensor(parameters);
  RunSettings settings;
  settings.nominal_step_ns = nanoseconds(0.02);
  Outcome outcome;
  outcome.status = run(
      facebow, clock, sensor, settings, outcome.counts,
      [&](const Sample&, const Estimate& estimate) { outcome.estimates.push_back(estimate); },
      [] { return false; });
  for (const TimeNs deadline : facebow.deadlines) EXPECT_EQ(deadline, settings.patience_ns);
  return outcome;
}

TEST(RunLoop, CountsWhatIsNotASampleAndGoesOn) {
  const Outcome outcome = run_script({{Status::ok, at(0, 0)},
                                      {Status::timeout, {}},
                                      {Status::bad_report, {}},
                                      {Status::ok, at(0.02, 0)},
                                      {Status::disconnected, {}},
                                      {Status::ok, at(0.04, 0)}});
  EXPECT_EQ(outcome.status, Status::disconnected);
  EXPECT_EQ(outcome.counts.samples, 2U);
  EXPECT_EQ(outcome.counts.timeouts, 1U);
  EXPECT_EQ(outcome.counts.bad_reports, 1U);
  EXPECT_EQ(outcome.estimates.size(), 2U);
}

TEST(RunLoop, OpensAgainWhatWentAwayAndGoesOnWithTheSameSensor) {
  ScriptedFacebow facebow({{Status::ok, at(0, 0)},
                           {Status::ok, at(0.02, 0.001)},
                           {Status::disconnected, {}},
                           {Status::ok, at(5, 0.002)},
                           {Status::disconnected, {}},
                           {Status::ok, at(9, 0.002)}});
  hal::ManualClock clock;
  PublishedParameters parameters;
  parameters.sample_time_s = 0.02;
  PublishedSensor<double> sensor(parameters);
  RunSettings settings;
  settings.nominal_step_ns = nanoseconds(0.02);
  settings.reopen_pause_ns = 1'000'000;
  RunCounts counts;
  EventSet last;
  EXPECT_EQ(run(
                facebow, clock, sensor, settings, counts,
                [&](const Sample&, const Estimate& estimate) { last = estimate.events; },
                [] { return false; }),
            Status::end);
  EXPECT_EQ(counts.samples, 4U);
  EXPECT_EQ(counts.disconnections, 2U);
  EXPECT_EQ(facebow.openings, 6);
  EXPECT_EQ(clock.now_ns(), 4 * settings.reopen_pause_ns);
  EXPECT_TRUE(last.has(Event::time_gap)) << "the sensor remembers what was before";
}

TEST(RunLoop, StopsWhileWaitingForWhatWentAway) {
  ScriptedFacebow facebow({{Status::disconnected, {}}});
  hal::ManualClock clock;
  PublishedSensor<double> sensor(PublishedParameters{});
  RunSettings settings;
  settings.reopen_pause_ns = 1'000'000;
  RunCounts counts;
  EXPECT_EQ(run(
                facebow, clock, sensor, settings, counts, [](const Sample&, const Estimate&) {},
                [&] { return facebow.openings == 2; }),
            Status::ok);
  EXPECT_EQ(counts.disconnections, 1U);
}

TEST(RunLoop, KeepsAReversedSampleFromTheEstimator) {
  const Outcome with = run_script({{Status::ok, at(0, 0)},
                                   {Status::ok, at(0.02, 0.001)},
                                   {Status::ok, at(-5, 0.5)},
                                   {Status::ok, at(0.04, 0.002)}});
  const Outcome without = run_script(
      {{Status::ok, at(0, 0)}, {Status::ok, at(0.02, 0.001)}, {Status::ok, at(0.04, 0.002)}});
  ASSERT_EQ(with.estimates.size(), 4U);
  EXPECT_TRUE(with.estimates[2].events.has(Event::time_reversed));
  EXPECT_EQ(with.estimates[2].position_m.provenance, Provenance::not_computed);
  EXPECT_EQ(with.estimates[3].velocity_m_s.value, without.estimates[2].velocity_m_s.value);
  EXPECT_EQ(with.counts.events[Event::time_reversed], 1U);
  EXPECT_EQ(with.counts.events[Event::time_gap], 0U)
      << "the row after it follows the row before it";
}

TEST(RunLoop, PredictsThroughAMissingPosition) {
  Sample missing = at(0.02, 0);
  missing.position_valid = false;
  const Outcome outcome =
      run_script({{Status::ok, at(0, 0)}, {Status::ok, missing}, {Status::ok, at(0.08, 0)}});
  EXPECT_TRUE(outcome.estimates[1].events.has(Event::position_missing));
  EXPECT_NE(outcome.estimates[1].position_m.provenance, Provenance::not_computed);
  EXPECT_TRUE(outcome.estimates[2].events.has(Event::time_gap));
  EXPECT_EQ(outcome.counts.events[Event::time_gap], 1U);
}

TEST(RunLoop, TakesNoZeroFilledDropoutForAMeasurement) {
  const auto point_at = [](double time_s, double z_m) {
    Sample sample = at(time_s, 0);
    sample.kind = SampleKind::one_point;
    sample.coordinates[2] = z_m;
    return sample;
  };
  const Outcome outcome = run_script({{Status::ok, point_at(0, -0.02)},
                                      {Status::ok, point_at(0.02, -0.02)},
                                      {Status::ok, point_at(0.04, 0)},
                                      {Status::ok, point_at(0.06, 0)}});
  EXPECT_EQ(outcome.counts.events[Event::zero_filled], 2U);
  EXPECT_EQ(outcome.estimates[3].position_m.provenance, Provenance::assumed);
  EXPECT_NEAR(outcome.estimates[3].position_m.value, -0.02, 1e-3);
}

TEST(RunLoop, StopsWhenTold) {
  ScriptedFacebow facebow({{Status::ok, at(0, 0)}, {Status::ok, at(0.02, 0)}});
  hal::ManualClock clock;
  PublishedSensor<double> sensor(PublishedParameters{});
  RunCounts counts;
  int taken = 0;
  EXPECT_EQ(run(
                facebow, clock, sensor, {}, counts,
                [&](const Sample&, const Estimate&) { ++taken; }, [&] { return taken == 1; }),
            Status::ok);
  EXPECT_EQ(taken, 1);
}

}  // namespace
}  // namespace condyle::firmware
