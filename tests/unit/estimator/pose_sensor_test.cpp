// SPDX-License-Identifier: Apache-2.0
// The whole pose from samples of an instrument.
#include "condyle/estimator/sensors/pose_sensor.h"

#include <gtest/gtest.h>

#include "unit/estimator/turning_jaw.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing_support::JawMotion;
using testing_support::kCondyle_m;
using testing_support::kPositionNoise_m;
using testing_support::noisy;
using testing_support::Random;

constexpr double kRate_Hz = 60, kRotationNoise_rad = 1e-3;
const JawMotion kChewing{};

// The usual bite fork in the jaw frame; the jaw's own frame is at its centre.
Matrix3d fork_m() {
  Matrix3d points;
  points << 0, 0.025, -0.025, 0, 0, 0, 0, 0.030, 0.030;
  return points;
}
const Vector3d kForkCentre_m(0, 0, 0.020);

Pose<double> measured(int i, Random& random) {
  return noisy(kChewing.pose(i / kRate_Hz), kPositionNoise_m, kRotationNoise_rad, random);
}

Sample sample_at(int i, SampleKind kind) {
  Sample sample;
  sample.time_ns = nanoseconds(i / kRate_Hz);
  sample.kind = kind;
  return sample;
}

Sample points_at(int i, const Pose<double>& pose) {
  Sample sample = sample_at(i, SampleKind::three_points);
  const Matrix3d around_centre = fork_m().colwise() - kForkCentre_m;
  const Matrix3d points = (pose.rotation * around_centre).colwise() + pose.translation;
  std::copy_n(points.data(), 9, sample.coordinates);
  return sample;
}

Sample pose_at(int i, const Pose<double>& pose) {
  Sample sample = sample_at(i, SampleKind::pose);
  const Eigen::Quaterniond q(pose.rotation);
  const double values[] = {
      pose.translation.x(), pose.translation.y(), pose.translation.z(), q.w(), q.x(), q.y(), q.z()};
  std::copy_n(values, 7, sample.coordinates);
  return sample;
}

double deviation(const Vector3d& truth, const VectorEstimate<double>& estimate) {
  return ((estimate.value - truth).array() / estimate.standard_deviation().array())
      .abs()
      .maxCoeff();
}

TEST(PoseSensor, FollowsAnyPointOfTheJawThroughThreePoints) {
  PoseSensor<double> sensor({}, 0, {.reference = Matrix3d::Identity(), .body_centre_m = {}});
  SampleChecker checker(nanoseconds(1 / kRate_Hz));
  Random random(1);
  for (int i = 0; i < 600; ++i) {
    const Sample sample = points_at(i, measured(i, random));
    const auto estimate = sensor.process(sample, checker.check(sample));
    const bool is_settled = i + 1 >= BodyShape<double>::kSamples;
    ASSERT_EQ(sensor.body().has_value(), is_settled);
    ASSERT_EQ(estimate.provenance() != Provenance::not_computed, is_settled) << i;
    if (i < 60) continue;
    EXPECT_EQ(estimate.provenance(), Provenance::measured);
    const Pose<double> truth = kChewing.pose(i / kRate_Hz);
    for (const Vector3d& point_m : {Vector3d(0, 0, 0), kCondyle_m}) {
      const auto found = estimate.point(kForkCentre_m + point_m);
      EXPECT_LE(deviation(point_of(truth, point_m), found.position_m), 5) << i;
      EXPECT_LE(deviation(kChewing.velocity_m_s(i / kRate_Hz, point_m), found.velocity_m_s), 5);
    }
    EXPECT_LE((estimate.body_centre_m - kForkCentre_m).norm(), 1e-12);
  }
}

TEST(PoseSensor, APoseSaysTheSameAsItsThreePoints) {
  const int lag = 3;
  PoseSensor<double> of_points({}, lag), of_pose({}, lag);
  Random random(2);
  PoseEstimate<double> a, b;
  const auto compare = [&] {
    ASSERT_EQ(a.is_ready, b.is_ready);
    ASSERT_EQ(a.time_ns, b.time_ns);
    if (!a.is_ready || a.provenance() == Provenance::not_computed) return;
    const auto by_points = a.point(kForkCentre_m + kCondyle_m), by_pose = b.point(kCondyle_m);
    EXPECT_LE((by_points.position_m.value - by_pose.position_m.value).norm(), 1e-9);
    EXPECT_LE((by_points.velocity_m_s.value - by_pose.velocity_m_s.value).norm(), 1e-6);
    EXPECT_EQ(a.provenance(), b.provenance());
  };
  for (int i = 0; i < 300; ++i) {
    const Pose<double> pose = measured(i, random);
    a = of_points.process(points_at(i, pose), {});
    Sample sample = pose_at(i, pose);
    sample.position_valid = i + 1 >= BodyShape<double>::kSamples;  // both begin then
    b = of_pose.process(sample, {});
    compare();
  }
  int waited = 0;
  for (; of_points.drain(a); ++waited) {
    ASSERT_TRUE(of_pose.drain(b));
    compare();
  }
  EXPECT_FALSE(of_pose.drain(b));
  EXPECT_EQ(waited, lag);
}

TEST(PoseSensor, SaysWhyThereIsNoPose) {
  Random random(3);
  const auto events_of = [](const Sample& sample) {
    PoseSensor<double> sensor({});
    const auto estimate = sensor.process(sample, {});
    EXPECT_EQ(estimate.provenance(), Provenance::not_computed);
    EXPECT_TRUE(estimate.events.has(Event::not_started));
    return estimate.events;
  };
  EXPECT_TRUE(events_of(sample_at(0, SampleKind::one_axis)).has(Event::position_missing));
  EXPECT_TRUE(events_of(sample_at(0, SampleKind::one_point)).has(Event::position_missing));
  Sample line = sample_at(0, SampleKind::three_points);
  EXPECT_TRUE(events_of(line).has(Event::points_not_rigid));
  line.coordinates[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(events_of(line).has(Event::position_missing));
  EXPECT_TRUE(events_of(sample_at(0, SampleKind::pose)).has(Event::points_not_rigid))
      << "no quaternion";
  MotionEstimatorParameters parameters;
  parameters.noise.memory_s = 0;
  PoseSensor<double> invalid(parameters);
  EXPECT_TRUE(
      invalid.process(pose_at(0, measured(0, random)), {}).events.has(Event::parameters_invalid));
}

TEST(PoseSensor, AFrozenDeviceIsNoMeasurement) {
  PoseSensor<double> sensor({});
  Random random(4);
  Sample sample;
  for (int i = 0; i < 400; ++i) {
    const auto time_ns = nanoseconds(i / kRate_Hz);
    if (i < 300) sample = pose_at(i, measured(i, random));
    sample.time_ns = time_ns;
    const auto estimate = sensor.process(sample, {});
    if (i < 305) continue;
    EXPECT_TRUE(estimate.events.has(Event::position_frozen));
    EXPECT_NE(estimate.provenance(), Provenance::measured);
  }
}

TEST(PoseSensor, ARepeatedReportIsOneMeasurement) {
  PoseSensor<double> once({}), twice({});
  SampleChecker checker;
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Sample sample = pose_at(i, measured(i, random));
    const auto expected = once.process(sample, {});
    const auto first = twice.process(sample, checker.check(sample));
    const auto repeated = twice.process(sample, checker.check(sample));
    EXPECT_EQ(first.centre_m.value, expected.centre_m.value);
    EXPECT_EQ(first.rotation, expected.rotation);
    EXPECT_TRUE(repeated.events.has(Event::time_repeated));
    EXPECT_EQ(repeated.provenance(), Provenance::not_computed);
  }
}

}  // namespace
}  // namespace condyle
