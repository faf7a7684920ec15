// SPDX-License-Identifier: Apache-2.0
#include "condyle/firmware/sensor_with_pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "condyle/estimator/sensors/recommended_sensor.h"

namespace condyle::firmware {
namespace {

// Three points of a body that turns about x, with a missing sample and a repeated time.
Sample sample_at(int i) {
  Sample sample;
  sample.kind = SampleKind::three_points;
  sample.time_ns = nanoseconds((i == 50 ? 49 : i) / 100.0);
  sample.position_valid = i != 40;
  const double angle_rad = 0.1 * std::sin(0.05 * i);
  const double shape_m[3][3] = {{0, -0.08, -0.04}, {0.025, -0.08, -0.01}, {-0.025, -0.08, -0.01}};
  for (int k = 0; k < 3; ++k) {
    sample.coordinates[3 * k] = shape_m[k][0] + 1e-5 * std::sin(100.0 * i);
    sample.coordinates[3 * k + 1] =
        shape_m[k][1] * std::cos(angle_rad) - shape_m[k][2] * std::sin(angle_rad);
    sample.coordinates[3 * k + 2] =
        shape_m[k][1] * std::sin(angle_rad) + shape_m[k][2] * std::cos(angle_rad);
  }
  return sample;
}

// What two sensors give alone, they give together, bit for bit, from the first sample to the last.
TEST(SensorWithPose, GivesWhatBothGiveAlone) {
  using Point = RecommendedSensor<double, 3>;
  const MotionEstimatorParameters parameters;
  for (const int lag : {0, 4}) {
    Point point(parameters, lag);
    PoseSensor<double> pose(parameters, lag);
    SensorWithPose<Point> both(pose, parameters, lag);
    static_assert(kHasPose<SensorWithPose<Point>::Estimate> && !kHasPose<Point::Estimate>);
    int ready = 0;
    const auto compare = [&](const SensorWithPose<Point>::Estimate& together,
                             const Point::Estimate& of_point, const PoseEstimate<double>& of_pose) {
      ASSERT_EQ(together.is_ready, of_point.is_ready);
      ASSERT_EQ(together.pose.is_ready, of_pose.is_ready);
      ASSERT_EQ(of_point.is_ready, of_pose.is_ready) << "one lag for both";
      if (!of_point.is_ready) return;
      ++ready;
      ASSERT_EQ(together.time_ns, of_point.time_ns);
      ASSERT_EQ(together.pose.time_ns, of_point.time_ns);
      ASSERT_EQ(together.pose.provenance(), of_pose.provenance());
      if (of_pose.provenance() == Provenance::not_computed) return;
      ASSERT_EQ(together.axes[1].position_m.value, of_point.axes[1].position_m.value);
      ASSERT_EQ(together.pose.centre_m.value, of_pose.centre_m.value);
      ASSERT_EQ(together.pose.rotation_vector_rad.value, of_pose.rotation_vector_rad.value);
    };
    SampleChecker checker(nanoseconds(0.01));
    for (int i = 0; i < 100; ++i) {
      const Sample sample = sample_at(i);
      const EventSet events = checker.check(sample);
      compare(both.process(sample, events), point.process(sample, events),
              pose.process(sample, events));
    }
    SensorWithPose<Point>::Estimate together;
    Point::Estimate of_point;
    PoseEstimate<double> of_pose;
    while (both.drain(together)) {
      ASSERT_TRUE(point.drain(of_point));
      ASSERT_TRUE(pose.drain(of_pose));
      compare(together, of_point, of_pose);
    }
    EXPECT_FALSE(point.drain(of_point));
    EXPECT_FALSE(pose.drain(of_pose));
    EXPECT_EQ(ready, 100);
  }
}

}  // namespace
}  // namespace condyle::firmware
