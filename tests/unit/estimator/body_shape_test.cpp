// SPDX-License-Identifier: Apache-2.0
// The shape that is learned from the first samples, and what it keeps a followed point from.
#include "condyle/estimator/pose/body_shape.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "condyle/estimator/pose/point_follower.h"
#include "support/random.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing_support::Random;

const Vector3d kCondyle_m(0, -0.010, -0.090);

// A bite fork (m) on a chewing jaw; each coordinate of each point with a noise of its own.
class Fork {
 public:
  explicit Fork(double noise_sd_m) : noise_sd_m_(noise_sd_m) {
    shape_ << 0, 0.025, -0.025, 0, 0, 0, 0, 0.030, 0.030;
  }
  // The next sample's points.
  Matrix3d points() {
    const double phase = 0.14 * ++count_;
    const double angle = 0.15 * (1 - std::cos(phase));
    rotation_ = Eigen::AngleAxisd(angle, Vector3d::UnitX()).toRotationMatrix();
    translation_ = {0, 0.010 * std::sin(phase), 0.1 - 0.012 * (1 - std::cos(phase))};
    Matrix3d points = (rotation_ * shape_).colwise() + translation_;
    for (double& coordinate : points.reshaped()) coordinate += noise_sd_m_ * random_.normal();
    return points;
  }
  // Where the condyle was in that sample.
  Vector3d condyle_m() const { return rotation_ * kCondyle_m + translation_; }
  const Matrix3d& shape_m() const { return shape_; }

 private:
  double noise_sd_m_;
  Random random_{7};
  int count_ = 0;
  Matrix3d shape_, rotation_;
  Vector3d translation_;
};

Sample sample_of(const Matrix3d& points) {
  Sample sample;
  sample.kind = SampleKind::three_points;
  std::copy_n(points.data(), 9, sample.coordinates);
  return sample;
}

FollowedPoint condyle(BodyFits& fits) {
  return {.body_point_m = kCondyle_m, .fits = &fits};
}

// The mean error (m) of the condyle over 600 samples, whose first `bad_samples` have point
// `bad_point` 3 mm off.
Vector3d mean_error_m(int bad_samples, int bad_point, const Vector3d& off_m, BodyFits& fits) {
  PointFollower<double> follower(condyle(fits));
  Fork fork(2e-5);
  Vector3d sum = Vector3d::Zero();
  int found_count = 0;
  for (int i = 0; i < 600; ++i) {
    Matrix3d points = fork.points();
    if (i < bad_samples) points.col(bad_point) += off_m;
    const FollowedPosition found = follower.follow(sample_of(points));
    if (found.status != PoseStatus::ok) continue;
    sum += found.position_m - fork.condyle_m();
    ++found_count;
  }
  EXPECT_GT(found_count, 560);
  return sum / found_count;
}

TEST(BodyShape, BadFirstSamplesBiasNothing) {
  for (const int bad_samples : {0, 1, 2, 3, 8, 11}) {
    for (const int bad_point : {0, 1, 2}) {
      for (const Vector3d& off_m :
           {Vector3d(0.003, 0, 0), Vector3d(0, 0, 0.003), Vector3d(0, 0.003, 0.003)}) {
        BodyFits fits;
        const Vector3d error_m = mean_error_m(bad_samples, bad_point, off_m, fits);
        // Of the shape of 15 noisy samples: some 15 um; of the first alone 2 mm.
        EXPECT_LT(error_m.cwiseAbs().maxCoeff(), 6e-5) << bad_samples << " " << bad_point;
        EXPECT_GE(fits.unsettled, 14U);
      }
    }
  }
}

TEST(BodyShape, ToleranceIsTiedToTheResidualsSeen) {
  for (const double noise_sd_m : {0.0, 5e-6, 5e-5, 2e-4, 6e-4}) {
    BodyFits fits;
    PointFollower<double> follower(condyle(fits));
    Fork fork(noise_sd_m);
    for (int i = 0; i < 2000; ++i) follower.follow(sample_of(fork.points()));
    EXPECT_EQ(fits.unsettled, 14U);
    EXPECT_LE(fits.not_rigid, noise_sd_m > 4e-4 ? 40U : 0U) << noise_sd_m;
    EXPECT_EQ(fits.fitted + fits.not_rigid, 1986U);
    const double residual_rms_m =
        std::sqrt(fits.residual_square_sum_m2 / static_cast<double>(fits.fitted));
    EXPECT_NEAR(residual_rms_m, noise_sd_m, 0.2 * noise_sd_m + 1e-15);
    const double expected_m = std::clamp(6 * noise_sd_m, kSmallestTolerance_m, kRigidTolerance_m);
    EXPECT_NEAR(fits.tolerance_m, expected_m, 0.4 * expected_m);
  }
}

TEST(BodyShape, PointsThatKeepNoDistancesMakeNoBody) {
  BodyFits fits;
  PointFollower<double> follower(condyle(fits));
  Fork fork(2e-3);
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(follower.follow(sample_of(fork.points())).status,
              i < 14 ? PoseStatus::unsettled : PoseStatus::not_rigid);
  }
  EXPECT_EQ(fits.fitted, 0U);
  EXPECT_FALSE(follower.body().has_value());
}

TEST(BodyShape, DistancesThatChangeForGoodAreSeenForGood) {
  BodyFits fits;
  PointFollower<double> follower(condyle(fits));
  Fork fork(2e-5);
  for (int i = 0; i < 500; ++i) {
    Matrix3d points = fork.points();
    if (i >= 200) points.col(0).x() += 1e-3;  // point 1 has slipped along the fork
    EXPECT_EQ(follower.follow(sample_of(points)).status == PoseStatus::ok, i >= 14 && i < 200) << i;
  }
  EXPECT_EQ(fits.not_rigid, 300U);
}

// Twelve samples with the same error settle a wrong shape: then nothing fits, and nothing is taken.
TEST(BodyShape, AWrongShapeIsNoPosition) {
  BodyFits fits;
  PointFollower<double> follower(condyle(fits));
  Fork fork(2e-5);
  for (int i = 0; i < 500; ++i) {
    Matrix3d points = fork.points();
    if (i < 30) points(2, 0) += 0.003;
    const bool is_found = follower.follow(sample_of(points)).status == PoseStatus::ok;
    EXPECT_EQ(is_found, i >= 14 && i < 30) << i;
  }
  EXPECT_EQ(fits.not_rigid, 470U);
}

TEST(BodyShape, ARepeatSaysNothingNew) {
  BodyShape<double> shape(kRigidTolerance_m);
  Fork fork(2e-5);
  Matrix3d bad = fork.points();
  bad(2, 0) += 0.003;
  for (int i = 0; i < 100; ++i) shape.add(bad);
  EXPECT_FALSE(shape.has_seen_enough());
  for (int i = 0; i < 14; ++i) shape.add(fork.points());
  ASSERT_TRUE(shape.is_settled());
  EXPECT_LT((shape.body().shape_m() - fork.shape_m()).cwiseAbs().maxCoeff(), 5e-5);
}

TEST(BodyShape, PointsOnALineAreCountedAndTeachNothing) {
  BodyFits fits;
  PointFollower<double> follower(condyle(fits));
  Fork fork(2e-5);
  for (int i = 0; i < 60; ++i) {
    Matrix3d points = fork.points();
    if (i % 2 == 0) points.col(2) = points.col(0);
    const PoseStatus status = follower.follow(sample_of(points)).status;
    if (i % 2 == 0) {
      EXPECT_EQ(status, PoseStatus::degenerate);
    } else {
      EXPECT_EQ(status, i < 29 ? PoseStatus::unsettled : PoseStatus::ok) << i;
    }
  }
  EXPECT_EQ(fits.degenerate, 30U);
  EXPECT_EQ(fits.unsettled, 14U);
  EXPECT_EQ(fits.fitted, 16U);
}

}  // namespace
}  // namespace condyle
