// SPDX-License-Identifier: Apache-2.0
// How well the estimates of a pose agree with what they state.
#include "condyle/estimator/pose/pose_estimator.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "unit/estimator/turning_jaw.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing_support::JawMotion;
using testing_support::kCondyle_m;
using testing_support::kPositionNoise_m;
using testing_support::kRotationNoise_rad;
using testing_support::noisy;
using testing_support::normal_vector;
using testing_support::Random;
using testing_support::timed;

// A motion drawn from the model: white jerk of centre and rotation vector.
class WhiteJerkPose {
 public:
  WhiteJerkPose(const MotionEstimatorParameters& parameters, double step_s, Random& random)
      : F_(white_jerk_jacobian(step_s)),
        root_(Eigen::LLT<Matrix3d>(parameters.noise.jerk_density_m2_s5 *
                                   white_jerk_covariance(step_s).dense())
                  .matrixL()),
        random_(random) {
    for (Vector3d& x : states_) {
      x = {0, parameters.prior.velocity_sd_m_s * random.normal(),
           parameters.prior.acceleration_sd_m_s2 * random.normal()};
    }
  }
  void move() {
    for (Vector3d& x : states_) {
      x = white_jerk_transition(x, F_) + root_ * normal_vector(random_);
    }
  }
  Pose<double> pose() const {
    return {rotation_of<double>(of_turn(0) / kTurnLength_m), of_centre(0)};
  }
  Vector3d velocity_m_s(const Vector3d& body_point_m) const {
    const Vector3d w = of_turn(0) / kTurnLength_m, rate = of_turn(1) / kTurnLength_m;
    return of_centre(1) + (left_jacobian(w) * rate).cross(rotation_of(w) * body_point_m);
  }

 private:
  Vector3d of_centre(int i) const { return {states_[0][i], states_[1][i], states_[2][i]}; }
  Vector3d of_turn(int i) const { return {states_[3][i], states_[4][i], states_[5][i]}; }

  TransitionJacobian<double> F_;
  Matrix3d root_;
  Random& random_;
  Vector3d states_[6];
};

// Squared error in units of its covariance.
double nees(const Vector3d& truth, const VectorEstimate<double>& estimate) {
  const Vector3d error = estimate.value - truth;
  return error.dot(estimate.covariance.inverse() * error);
}

// With the noise and the liveliness known, the errors' covariance is exact but for the curvature of
// rotations: at 0.3 rad, less than 1 %.
TEST(PoseEstimator, ErrorsHaveTheStatedCovariance) {
  MotionEstimatorParameters parameters;
  parameters.noise.adaptation = Adaptation::off;
  parameters.noise.position_sd_m = kPositionNoise_m;
  parameters.noise.rotation_sd_rad = kRotationNoise_rad;
  parameters.noise.jerk_density_m2_s5 = 1e-3;
  parameters.prior = {.velocity_sd_m_s = 0.02, .acceleration_sd_m_s2 = 0.05};
  parameters.outliers.huber_sd = parameters.outliers.gate_sd = 100;
  constexpr int kRuns = 2000, kSamples = 60;
  constexpr double kStep_s = 1.0 / 60;
  const Vector3d far_point_m(0, 0, 0.1);
  Random random(1);
  double of_position = 0, of_velocity = 0;
  for (int run = 0; run < kRuns; ++run) {
    WhiteJerkPose truth(parameters, kStep_s, random);
    PoseEstimator<double, 0> estimator(parameters);
    estimator.set_reference(Matrix3d::Identity());
    PoseEstimate<double> estimate;
    for (int i = 0; i < kSamples; ++i) {
      if (i > 0) truth.move();
      estimate = estimator.step(
          timed(i * kStep_s, noisy(truth.pose(), kPositionNoise_m, kRotationNoise_rad, random)));
    }
    const auto point = estimate.point(far_point_m);
    of_position += nees(point_of(truth.pose(), far_point_m), point.position_m) / kRuns;
    of_velocity += nees(truth.velocity_m_s(far_point_m), point.velocity_m_s) / kRuns;
  }
  // Chi-square with 3 degrees of freedom has mean 3 and variance 6: 5 standard deviations of the
  // mean, which a right covariance exceeds in one of 1.7 million seeds.
  const double tolerance = 5 * std::sqrt(6.0 / kRuns);
  EXPECT_NEAR(of_position, 3, tolerance);
  EXPECT_NEAR(of_velocity, 3, tolerance);
}

// How often an interval of 95 % holds the truth.
class Coverage {
 public:
  void add(double error, double standard_deviation) {
    held_ += std::abs(error) <= kNormalQuantile95 * standard_deviation ? 1 : 0;
    ++count_;
  }
  void add(const Vector3d& truth, const VectorEstimate<double>& estimate) {
    for (int i = 0; i < 3; ++i) {
      add(estimate.value[i] - truth[i], estimate.standard_deviation()[i]);
    }
  }
  void add(const Coverage& other) {
    held_ += other.held_;
    count_ += other.count_;
  }
  double share() const { return held_ / static_cast<double>(count_); }

 private:
  int held_ = 0, count_ = 0;
};

struct Coverages {
  Coverage position, velocity, rate, twist;

  void add(const PoseEstimate<double>& estimate, const JawMotion& motion) {
    const double time_s = seconds(estimate.time_ns);
    const Pose<double> truth = motion.pose(time_s);
    const auto point = estimate.point(kCondyle_m);
    position.add(point_of(truth, kCondyle_m), point.position_m);
    velocity.add(motion.velocity_m_s(time_s, kCondyle_m), point.velocity_m_s);
    rate.add(motion.angular_velocity_rad_s(time_s), estimate.angular_velocity_rad_s);
    const Vector3d w = rotation_vector_of(truth.rotation);
    const auto turn = estimate.turn_about(JawMotion::hinge());
    twist.add(turn.twist_rad.value - swing_twist_of(w, JawMotion::hinge()).twist_rad,
              turn.twist_rad.standard_deviation);
  }
  void add(const Coverages& other) {
    position.add(other.position);
    velocity.add(other.velocity);
    rate.add(other.rate);
    twist.add(other.twist);
  }
};

// Noise and liveliness are learned, from 2 s on; 20 s of each motion.
Coverages coverages_of(const JawMotion& motion, double rate_Hz, int lag) {
  PoseEstimator<double> estimator({}, lag);
  estimator.set_reference(Matrix3d::Identity());
  Random random(7);
  Coverages coverages;
  EventCounts counts;
  int unmeasured = 0, estimates = 0;  // unmeasured: rates that are not
  for (int i = 0; i < 20 * rate_Hz; ++i) {
    const double time_s = i / rate_Hz;
    const auto estimate = estimator.step(
        timed(time_s, noisy(motion.pose(time_s), kPositionNoise_m, kRotationNoise_rad, random)));
    counts.add(estimate.events);
    if (!estimate.is_ready || estimate.time_ns < 2 * kNanosecondsPerSecond) continue;
    EXPECT_EQ(estimate.provenance(), Provenance::measured);
    const bool is_measured = estimate.angular_velocity_rad_s.provenance == Provenance::measured;
    unmeasured += is_measured ? 0 : 1;
    ++estimates;
    coverages.add(estimate, motion);
  }
  EXPECT_EQ(counts[Event::outlier_rejected], 0U);
  EXPECT_EQ(counts[Event::motion_changed], 0U);
  // Where a sample far from the prediction allows for a sudden movement.
  EXPECT_LE(unmeasured, 0.02 * estimates);
  return coverages;
}

// The limits contain every motion by itself; errors are correlated in time, so one motion of 20 s
// says little. The means over 18 motions are narrower.
TEST(PoseEstimator, IntervalsHoldOverTheMotionsOfAJaw) {
  for (const int lag : {0, 8}) {
    Coverages all;
    for (const double rate_Hz : {60.0, 200.0}) {
      for (const double frequency_Hz : {0.3, 1.0, 3.0}) {
        for (const double angle_deg : {5.0, 15.0, 30.0}) {
          const JawMotion motion{.frequency_Hz = frequency_Hz,
                                 .angle_rad = angle_deg * std::numbers::pi / 180,
                                 .travel_m = 4e-4 * angle_deg};
          const Coverages one = coverages_of(motion, rate_Hz, lag);
          for (const Coverage& share : {one.position, one.velocity, one.rate, one.twist}) {
            EXPECT_GE(share.share(), 0.91) << lag << " " << rate_Hz << " " << frequency_Hz;
          }
          all.add(one);
        }
      }
    }
    const auto expect_share = [lag](const Coverage& coverage, double most, const char* name) {
      EXPECT_GE(coverage.share(), 0.94) << name << ", lag " << lag;
      EXPECT_LE(coverage.share(), most) << name << ", lag " << lag;
      testing::Test::RecordProperty(std::string(name) + "_lag_" + std::to_string(lag),
                                    std::to_string(coverage.share()));
    };
    // Allowances for sudden movements and a tremor make intervals wider where the jaw moves slowly.
    expect_share(all.position, 0.99, "position");
    expect_share(all.twist, 0.99, "twist");
    expect_share(all.velocity, 0.999, "velocity");
    expect_share(all.rate, 0.999, "angular_velocity");
  }
}

// Each estimate has the time of its sample, in order. A sample without a time is reported as one.
TEST(PoseEstimator, EstimatesHaveTheTimesOfTheirSamples) {
  constexpr int kSamples = 30;
  constexpr double kStep_s = 0.01;
  for (const int lag : {0, 8}) {
    PoseEstimator<double> estimator({}, lag);
    estimator.set_reference(Matrix3d::Identity());
    int given = 0;
    const auto expect_next = [&](const PoseEstimate<double>& estimate) {
      EXPECT_TRUE(estimate.time_valid) << given;
      EXPECT_EQ(estimate.time_ns, nanoseconds(given * kStep_s));
      ++given;
    };
    for (int i = 0; i < kSamples; ++i) {
      const auto estimate =
          estimator.step(timed(i * kStep_s, {Matrix3d::Identity(), Vector3d(0, 0, 1e-4 * i)}));
      EXPECT_EQ(estimate.is_ready, i >= lag);
      if (estimate.is_ready) expect_next(estimate);
    }
    PoseEstimate<double> left;
    while (estimator.drain(left)) expect_next(left);
    EXPECT_EQ(given, kSamples);
  }
  PoseEstimator<double> estimator({});
  for (const bool is_known : {false, true}) {
    EXPECT_EQ(estimator.skip({}, is_known).time_valid, is_known);
  }
}

}  // namespace
}  // namespace condyle
