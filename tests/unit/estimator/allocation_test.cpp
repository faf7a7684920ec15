// SPDX-License-Identifier: Apache-2.0
// No step allocates.
#include <gtest/gtest.h>

#include <memory>

#include "condyle/estimator/changes/change_detector.h"
#include "condyle/estimator/emg/emg_envelope.h"
#include "condyle/estimator/emg/emg_timeline.h"
#include "condyle/estimator/motion/frozen_detector.h"
#include "condyle/estimator/motion/recommended_estimator.h"
#include "condyle/estimator/pose/point_follower.h"
#include "condyle/estimator/sensors/cycle_sensor.h"
#include "condyle/estimator/sensors/pose_sensor.h"
#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/firmware/run_loop.h"
#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/report_tracker.h"
#include "observability/observability.h"
#include "support/allocation_counter.h"
#include "support/driven_chewing.h"

namespace condyle {
namespace {

using testing_support::allocation_count;

class Allocation : public testing::Test {
  void SetUp() override {
    if (MALLOC_IS_TAKEN) GTEST_SKIP() << "the sanitizer replaces malloc itself";
  }
};

TEST_F(Allocation, IsCounted) {
  const long before = allocation_count();
  const auto pointer = std::make_unique<volatile int>(1);
  EXPECT_GT(allocation_count(), before);
}

// Delivers a ramp with a gap, a repeated and a reversed time and a missing position.
class RampFacebow final : public hal::Facebow {
 public:
  hal::Status open() override { return hal::Status::ok; }
  hal::Status read(TimeNs, Sample& sample) override {
    if (count_ == 1000) return hal::Status::end;
    sample.time_ns = 20'000'000 * (count_ % 100 == 7 ? count_ - 3 : count_);
    sample.coordinates[0] = 0.001 * static_cast<double>(count_);
    sample.position_valid = count_ % 50 != 3;
    ++count_;
    return hal::Status::ok;
  }
  void close() override {}

 private:
  TimeNs count_ = 0;
};

template <class Scalar>
void expect_run_without_allocation() {
  PublishedParameters parameters;
  parameters.sample_time_s = 0.02;
  PublishedSensor<Scalar> sensor(parameters);
  RampFacebow facebow;
  hal::ManualClock clock;
  firmware::RunCounts counts;
  firmware::RunSettings settings;
  settings.nominal_step_ns = 20'000'000;
  const long before = allocation_count();
  const hal::Status status = firmware::run(
      facebow, clock, sensor, settings, counts,
      [](const Sample&, const PublishedEstimate<Scalar>&) {}, [] { return false; });
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(status, hal::Status::end);
  EXPECT_EQ(counts.samples, 1000U);
  EXPECT_EQ(counts.events[Event::position_missing], 20U);
  EXPECT_GT(counts.events[Event::time_reversed], 0U);
}

TEST_F(Allocation, RunOfTheCascadeHasNoneInDouble) {
  expect_run_without_allocation<double>();
}
TEST_F(Allocation, RunOfTheCascadeHasNoneInFloat) {
  expect_run_without_allocation<float>();
}

// With gaps, outliers, a displacement and missing samples, so that all paths are walked.
template <class Scalar, int kAxes>
void expect_recommended_without_allocation(int lag) {
  const long before = allocation_count();
  RecommendedEstimator<Scalar, kAxes> estimator({}, lag);
  RecommendedEstimate<Scalar> estimate;
  EventCounts counts;
  TimeNs time_ns = 0;
  for (int i = 0; i < 1000; ++i) {
    time_ns += i % 100 == 99 ? 500'000'000 : 20'000'000;
    TimedPosition<Scalar, kAxes> measurement{i % 200 == 7 ? 0 : time_ns, i % 50 != 3, {}, {}};
    for (Scalar& position_m : measurement.position_m) {
      position_m = Scalar(1e-4) * Scalar(i * 7 % 5) + Scalar(i % 300 > 150 || i % 40 == 9);
    }
    estimate = estimator.step(measurement);
    counts.add(estimate.events);
  }
  while (estimator.drain(estimate)) counts.add(estimate.events);
  EXPECT_EQ(allocation_count(), before);
  for (const Event event :
       {Event::outlier_rejected, Event::state_restarted, Event::time_reversed}) {
    EXPECT_GT(counts[event], 0U) << event_name(event);
  }
}

TEST_F(Allocation, RecommendedEstimatorHasNone) {
  for (const int lag : {0, 16}) {
    expect_recommended_without_allocation<double, 1>(lag);
    expect_recommended_without_allocation<float, 1>(lag);
    expect_recommended_without_allocation<double, 3>(lag);
    expect_recommended_without_allocation<float, 3>(lag);
  }
}

// Delivers a bite fork on a jaw that opens and closes, with glitches, dropouts, a gap and a rest.
class ForkFacebow final : public hal::Facebow {
 public:
  hal::Status open() override { return hal::Status::ok; }
  hal::Status read(TimeNs, Sample& sample) override {
    if (count_ == 1000) return hal::Status::end;
    time_ns_ += count_ == 500 ? 400'000'000 : 20'000'000;
    sample.time_ns = time_ns_;
    sample.kind = SampleKind::three_points;
    const double angle_rad = count_ < 900 ? 0.1 * std::sin(0.1 * count_) : 0;
    for (int i = 0; i < 3; ++i) {
      const double x_m = 0.025 * (i % 2 - i / 2), z_m = i == 0 ? 0 : 0.03;
      sample.coordinates[3 * i] = x_m + 1e-5 * (count_ % 7);
      sample.coordinates[3 * i + 1] = z_m * std::sin(angle_rad);
      sample.coordinates[3 * i + 2] = z_m * std::cos(angle_rad);
      if (count_ % 50 == 9) sample.coordinates[3 * i + 1] += 0.05;  // far off, and rigid
    }
    sample.position_valid = count_ % 50 != 3;
    ++count_;
    return hal::Status::ok;
  }
  void close() override {}

 private:
  int count_ = 0;
  TimeNs time_ns_ = 0;
};

template <class Scalar>
void expect_pose_without_allocation(int lag) {
  const long before = allocation_count();
  PoseSensor<Scalar> sensor({}, lag);
  ForkFacebow facebow;
  hal::ManualClock clock;
  firmware::RunCounts counts;
  int estimates = 0;
  firmware::RunSettings settings;
  settings.nominal_step_ns = 20'000'000;
  const hal::Status status = firmware::run(
      facebow, clock, sensor, settings, counts,
      [&estimates](const Sample&, const PoseEstimate<Scalar>& estimate) {
        const auto point = estimate.point({0, 0, Scalar(-0.1)});
        const auto turn = estimate.turn_about({1, 0, 0});
        estimates += point.position_m.provenance == turn.twist_rad.provenance &&
                             estimate.provenance() != Provenance::not_computed
                         ? 1
                         : 0;
      },
      [] { return false; });
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(status, hal::Status::end);
  EXPECT_GT(estimates, 900);
  for (const Event event : {Event::time_gap, Event::outlier_rejected, Event::position_missing,
                            Event::state_restarted}) {
    EXPECT_GT(counts.events[event], 0U) << event_name(event);
  }
}

TEST_F(Allocation, EstimatingThePoseHasNone) {
  for (const int lag : {0, 16}) {
    expect_pose_without_allocation<double>(lag);
    expect_pose_without_allocation<float>(lag);
  }
}

// Identification, cycles and detector, over gaps in the drive and an alarm.
template <class Scalar>
void expect_watch_without_allocation() {
  RecommendedParameters parameters;
  parameters.changes.identification_s = 10;
  parameters.changes.cycles.largest_sd_Ns_m = 10;
  parameters.changes.detector.baseline_cycles = 10;
  testing_support::DrivenChewing chewing({}, 60, 1);
  const long before = allocation_count();
  CycleSensor<Scalar, 1> sensor(parameters, {}, 0);
  ChangeDetector<Scalar> detector(parameters.changes.detector);
  Sample sample;
  int counted = 0;
  for (int i = 0; i < 6000; ++i) {
    const auto measured = chewing.next();
    sample.time_ns += i % 2000 == 1500 ? 400'000'000 : 16'666'667;
    sample.coordinates[0] = measured.position_m;
    sample.drive_N = measured.drive_N;
    sample.drive_valid = i % 500 != 7;
    const auto estimate = sensor.process(sample, {});
    for (std::size_t j = 0; j < estimate.cycle_count; ++j) {
      const CycleReport<Scalar>& cycle = estimate.cycles[j].report;
      if (cycle.outcome != CycleOutcome::counted) continue;
      ++counted;
      const Scalar shift = counted > 40 ? Scalar(1) : Scalar(0);
      (void)detector.add(cycle.friction_Ns_m + shift, cycle.standard_deviation);
    }
  }
  EXPECT_EQ(allocation_count(), before);
  EXPECT_GT(counted, 80);
  EXPECT_EQ(detector.state(), ChangeState::increased);
  EXPECT_GT(sensor.counts().drive_gaps, 0U);
}

TEST_F(Allocation, WatchingForChangesHasNone) {
  expect_watch_without_allocation<double>();
  expect_watch_without_allocation<float>();
}

TEST_F(Allocation, DecodingAndFollowingReportsHaveNone) {
  using namespace hal;
  const auto field = [](std::uint32_t offset_bits, FieldType type) {
    return ReportField{.offset_bits = offset_bits, .width_bits = 16, .type = type};
  };
  DeviceProfile profile;
  profile.minimum_size_bytes = 16;
  for (std::uint32_t i = 0; i < 3; ++i) {
    profile.coordinates.push_back({field(48 + 16 * i, FieldType::signed_integer), i});
  }
  profile.sequence = CountingField{field(0, FieldType::unsigned_integer)};
  profile.device_time = CountingField{field(16, FieldType::unsigned_integer)};
  profile.checksum = Checksum{.field = field(32, FieldType::unsigned_integer),
                              .polynomial = 0x1021,
                              .first_byte = 6,
                              .end_byte = 16};
  profile.auxiliary.push_back({"emg", "V", field(96, FieldType::signed_integer)});
  const ReportDecoder decoder(layout_of(profile));
  ReportTracker tracker(profile);
  std::array<std::uint8_t, 16> bytes{};
  const long before = allocation_count();
  for (std::uint8_t i = 0; i < 100; ++i) {
    bytes[0] = bytes[2] = i;
    bytes[5] = i % 10 == 9 ? 1 : 0;
    DecodedReport report;
    const ReportFault fault = decoder.decode(bytes, report);
    if (fault == ReportFault::none) {
      static_cast<void>(tracker.accept(report, i));
    } else {
      tracker.refuse(fault);
    }
  }
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(tracker.counts().received, 90U);
  EXPECT_EQ(tracker.counts().wrong_checksum, 10U);
  EXPECT_EQ(tracker.counts().lost, 9U) << "the last one nobody has missed yet";
}

template <class Scalar>
void expect_emg_without_allocation() {
  MuscleSet muscles;
  muscles.count = 2;
  muscles.muscle[1].arm = -0.03;
  EmgTimeline<Scalar> timeline(EmgParameters{}, muscles);
  EmgEnvelope<Scalar> envelope(EnvelopeParameters{});
  const long before = allocation_count();
  for (int i = 0; i < 2000; ++i) {
    const auto excitation = envelope.add(Scalar(i % 7) - Scalar(3)).excitation / Scalar(100);
    timeline.add_emg(1'000'000 * TimeNs{i}, {excitation, excitation});
    if (i % 10 == 0) timeline.add_position(1'000'000 * TimeNs{i}, Scalar(-0.001), Scalar(5e-5));
  }
  const auto estimate = timeline.estimate();
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(estimate.outcome, EmgOutcome::updated);
}

TEST_F(Allocation, IdentificationFromEmgHasNone) {
  expect_emg_without_allocation<double>();
  expect_emg_without_allocation<float>();
}

TEST_F(Allocation, ObservabilityHasNone) {
  const long before = allocation_count();
  const auto result =
      judge_observability(observability_matrix<FullSystem>(OperatingPoint<double>{}));
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(result.rank, 4);
}

TEST_F(Allocation, FollowingAPointAndNoticingAFreezeHaveNone) {
  Sample sample;
  sample.kind = SampleKind::three_points;
  sample.coordinates[3] = 0.025;
  sample.coordinates[6] = -0.025;
  sample.coordinates[5] = sample.coordinates[8] = 0.03;
  const long before = allocation_count();
  PointFollower<double> follower(FollowedPoint{1, Eigen::Vector3d(0, 0, 0.1)});
  FrozenDetector detector;
  int frozen = 0;
  for (int i = 0; i < 100; ++i) {
    sample.coordinates[0] = 1e-5 * std::min(i, BodyShape<double>::kSamples);  // learns, then rests
    EXPECT_EQ(follower.follow(sample).status,
              i + 1 < BodyShape<double>::kSamples ? PoseStatus::unsettled : PoseStatus::ok);
    frozen += detector.add(sample) ? 1 : 0;
  }
  sample.coordinates[5] = 1;
  EXPECT_EQ(follower.follow(sample).status, PoseStatus::not_rigid);
  EXPECT_EQ(allocation_count(), before);
  EXPECT_GT(frozen, 50);
}

}  // namespace
}  // namespace condyle
