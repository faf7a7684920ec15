// SPDX-License-Identifier: Apache-2.0
// Estimates of a pose through gaps, glitches and dropouts, in other frames and in float.
#include <gtest/gtest.h>

#include "condyle/estimator/pose/pose_estimator.h"
#include "support/rapidcheck_gtest.h"
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
using testing_support::number_between;
using testing_support::Random;
using testing_support::timed;

constexpr double kRate_Hz = 60;
constexpr int kTold = 200;  // samples until noise and motion are known
const JawMotion kChewing{};

std::vector<TimedPose<double>> chewing(int samples, std::uint64_t seed) {
  Random random(seed);
  std::vector<TimedPose<double>> all;
  for (int i = 0; i < samples; ++i) {
    const double time_s = i / kRate_Hz;
    all.push_back(
        timed(time_s, noisy(kChewing.pose(time_s), kPositionNoise_m, kRotationNoise_rad, random)));
  }
  return all;
}

// Deviation of the estimated point from the truth along its worst axis, in standard deviations.
double deviation(const PoseEstimate<double>& estimate) {
  const auto point = estimate.point(kCondyle_m).position_m;
  const Vector3d truth = point_of(kChewing.pose(seconds(estimate.time_ns)), kCondyle_m);
  return ((point.value - truth).array() / point.standard_deviation().array()).abs().maxCoeff();
}

TEST(PoseEstimator, AGlitchInOneHalfEntersNeither) {
  for (const bool is_turned : {false, true}) {
    for (const double size : {0.003, 0.005, 0.008}) {
      auto samples = chewing(kTold + 30, 3);
      PoseEstimator<double> estimator({});
      for (int i = 0; i < kTold + 30; ++i) {
        Pose<double>& pose = samples[static_cast<std::size_t>(i)].pose;
        if (i == kTold && is_turned) {
          pose.rotation = rotation_of<double>({0, size / 0.025, 0}) * pose.rotation;
        } else if (i == kTold) {
          pose.translation.y() += size;
        }
        const auto estimate = estimator.step(samples[static_cast<std::size_t>(i)]);
        if (i < kTold - 20) continue;
        ASSERT_LE(deviation(estimate), 5) << i - kTold << " " << size;
        if (i != kTold) continue;
        EXPECT_TRUE(is_unexpected(estimate.events));
        EXPECT_EQ(estimate.provenance(), Provenance::derived);
        const auto& fine = is_turned ? estimator.centre() : estimator.turn();
        EXPECT_FALSE(fine.motion().has_other()) << "it has only predicted";
      }
    }
  }
}

// Samples off by 3 to 8 mm, and turned as one such point turns a bite fork: `burst` of them in a
// row, every 40 samples. Returns how many estimates of 2800 are off by more than 5 standard
// deviations.
struct FarEstimates {
  int count = 0, longest_run = 0;
};
FarEstimates far_after_glitches(int burst, int lag, bool shifts, bool turns) {
  auto samples = chewing(3000, 5);
  Random random(6);
  for (std::size_t i = kTold; i < samples.size(); ++i) {
    if (static_cast<int>(i % 40) >= burst) continue;
    const double size_m = 0.003 + 0.005 * random.uniform();
    Pose<double>& pose = samples[i].pose;
    const Vector3d shift = size_m * normal_vector(random).normalized();
    const Vector3d turn = size_m / 0.03 * normal_vector(random).normalized();
    if (shifts) pose.translation += shift;
    if (turns) pose.rotation = rotation_of(turn) * pose.rotation;
  }
  PoseEstimator<double> estimator({}, lag);
  FarEstimates far;
  int run = 0;
  for (const auto& sample : samples) {
    const auto estimate = estimator.step(sample);
    if (!estimate.is_ready || estimate.time_ns < nanoseconds(kTold / kRate_Hz)) continue;
    run = deviation(estimate) <= 5 ? 0 : run + 1;
    far.count += run > 0 ? 1 : 0;
    far.longest_run = std::max(far.longest_run, run);
  }
  return far;
}

TEST(PoseEstimator, GlitchesLeaveNoRunaway) {
  for (const int lag : {0, 8}) {
    for (const auto& [shifts, turns] : {std::pair{true, false}, {false, true}, {true, true}}) {
      EXPECT_EQ(far_after_glitches(1, lag, shifts, turns).count, 0);
      // Offsets in a row may look like a motion, until good samples contradict it.
      for (const int burst : {2, 3}) {
        const FarEstimates far = far_after_glitches(burst, lag, shifts, turns);
        EXPECT_LE(far.count, 90) << burst << " " << lag;
        EXPECT_LE(far.longest_run, 5) << burst << " " << lag;
      }
    }
  }
}

TEST(PoseEstimator, PredictsAcrossAShortGapAndLosesTheMotionInALongOne) {
  const auto samples = chewing(600, 9);
  PoseEstimator<double> estimator({});
  Vector3d before = Vector3d::Zero();
  for (int i = 0; i < 600; ++i) {
    auto sample = samples[static_cast<std::size_t>(i)];
    if ((i >= 300 && i < 306) || (i >= 400 && i < 440)) {
      sample.is_measured = false;
      sample.pose.translation.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    const auto estimate = estimator.step(sample);
    const Vector3d sd = estimate.point(kCondyle_m).position_m.standard_deviation();
    if (i >= 300 && i < 306) {
      EXPECT_EQ(estimate.provenance(), Provenance::derived);
      EXPECT_TRUE((sd.array() > before.array()).all()) << "wider from sample to sample";
    }
    const bool is_lost = i >= 415 && i < 440;
    if (is_lost) {
      EXPECT_EQ(estimate.provenance(), Provenance::not_computed) << i;
      EXPECT_TRUE(estimate.events.has(Event::state_lost));
      EXPECT_TRUE(estimate.point(kCondyle_m).position_m.value.array().isNaN().all());
      EXPECT_EQ(estimate.turn_about(JawMotion::hinge()).twist_rad.provenance,
                Provenance::not_computed);
    } else if (i >= kTold) {
      EXPECT_LE(deviation(estimate), 5) << i;
    }
    EXPECT_EQ(estimate.events.has(Event::state_restarted), i == 440);
    before = sd;
  }
}

TEST(PoseEstimator, NumbersThatAreNoneEnterNoState) {
  const auto samples = chewing(300, 2);
  for (int entry = 0; entry < 12; ++entry) {
    PoseEstimator<double> with({}), without({});
    for (int i = 0; i < 300; ++i) {
      auto bad = samples[static_cast<std::size_t>(i)],
           missing = samples[static_cast<std::size_t>(i)];
      if (i % 50 == 49) {
        (entry < 9 ? bad.pose.rotation(entry) : bad.pose.translation[entry - 9]) =
            std::numeric_limits<double>::quiet_NaN();
        missing.is_measured = false;
      }
      const auto estimate = with.step(bad), expected = without.step(missing);
      EXPECT_EQ(estimate.events.has(Event::position_missing), i % 50 == 49);
      ASSERT_EQ(estimate.centre_m.value, expected.centre_m.value);
      ASSERT_EQ(estimate.rotation, expected.rotation);
    }
  }
}

TEST(PoseEstimator, APoseBeyondTheFarthestTurnIsNotUsed) {
  PoseEstimator<double> estimator({});
  for (int i = 0; i < 400; ++i) {
    const double angle_rad = 0.01 * i;
    const auto estimate = estimator.step(
        timed(i / kRate_Hz, {rotation_of<double>({0, angle_rad, 0}), Vector3d::Zero()}));
    const bool is_far = angle_rad > kFarthestTurn_rad && angle_rad < 2 * std::numbers::pi - 2.5;
    EXPECT_EQ(estimate.events.has(Event::position_missing), is_far) << i;
  }
  EXPECT_EQ(estimator.far_turned(), 128U);
}

// What a change of the instrument's frame, a rotation and a shift, does to the estimated point.
struct Frame {
  Matrix3d rotation;
  Vector3d shift_m;

  TimedPose<double> of(TimedPose<double> measurement) const {
    measurement.pose.rotation = rotation * measurement.pose.rotation;
    measurement.pose.translation = rotation * measurement.pose.translation + shift_m;
    return measurement;
  }
};

// Largest differences between the frames of the point's position and velocity, after kTold samples:
// of the values, and of the covariances; in standard deviations and their squares.
struct Difference {
  double values = 0, covariances = 0;
};
Difference largest_difference(const MotionEstimatorParameters& parameters, const Frame& frame) {
  PoseEstimator<double> here(parameters), there(parameters);
  Difference largest;
  for (const auto& sample : chewing(600, 4)) {
    const auto a = here.step(sample).point(kCondyle_m);
    const auto b = there.step(frame.of(sample)).point(kCondyle_m);
    if (sample.time_ns < nanoseconds(kTold / kRate_Hz)) continue;
    for (const auto& [of_a, of_b, shift_m] :
         {std::tuple{a.position_m, b.position_m, frame.shift_m},
          std::tuple{a.velocity_m_s, b.velocity_m_s, Vector3d(0, 0, 0)}}) {
      const Vector3d value = frame.rotation * of_a.value + shift_m;
      const Matrix3d covariance = frame.rotation * of_a.covariance * frame.rotation.transpose();
      const double variance = covariance.trace();
      largest.values = std::max(largest.values, (of_b.value - value).norm() / std::sqrt(variance));
      largest.covariances =
          std::max(largest.covariances, (of_b.covariance - covariance).norm() / variance);
    }
  }
  return largest;
}

RC_GTEST_PROP(PoseEstimator, TurnsWithTheFrameIfItDoesNotAdapt, ()) {
  MotionEstimatorParameters parameters;
  parameters.noise.adaptation = Adaptation::off;
  parameters.outliers.huber_sd = parameters.outliers.gate_sd = 100;
  const Vector3d w(*number_between(-1.5, 1.5), *number_between(-1.5, 1.5),
                   *number_between(-1.5, 1.5));
  const Difference largest = largest_difference(parameters, {rotation_of(w), 0.3 * w});
  RC_ASSERT(largest.values <= 1e-9);
  RC_ASSERT(largest.covariances <= 1e-9);
}

TEST(PoseEstimator, TurnsWithTheFrameIfAxesAreExchanged) {
  Frame frame{Matrix3d::Zero(), {0.1, 0.2, -0.3}};
  frame.rotation << 0, 1, 0, 0, 0, -1, -1, 0, 0;
  const Difference largest = largest_difference({}, frame);
  EXPECT_LE(largest.values, 1e-9);
  EXPECT_LE(largest.covariances, 1e-9);
}

// Else what is learned axis by axis differs: the values by a fraction of their standard deviation,
// the velocity's variance by a factor where it allows for a sudden movement.
TEST(PoseEstimator, TurnsRoughlyWithTheFrameIfItAdapts) {
  for (const double size_rad : {0.1, 0.3, 0.7, 1.2}) {
    const Frame frame{rotation_of<double>(size_rad * Vector3d(0.7, 0.3, -0.65)), {0, 0, 0}};
    EXPECT_LE(largest_difference({}, frame).values, 1.5) << size_rad;
  }
}

TEST(PoseEstimator, FloatIsCloseToDouble) {
  PoseEstimator<double> in_double({});
  PoseEstimator<float> in_float({});
  double largest = 0;
  for (const auto& sample : chewing(1000, 8)) {
    TimedPose<float> rounded;
    rounded.time_ns = sample.time_ns;
    rounded.is_measured = true;
    rounded.pose = {sample.pose.rotation.cast<float>(), sample.pose.translation.cast<float>()};
    const auto expected = in_double.step(sample).point(kCondyle_m);
    const auto found = in_float.step(rounded).point(kCondyle_m.cast<float>());
    for (const auto& [a, b] : {std::pair{&expected.position_m, &found.position_m},
                               std::pair{&expected.velocity_m_s, &found.velocity_m_s}}) {
      const Vector3d sd = a->standard_deviation();
      const Vector3d difference = b->value.cast<double>() - a->value;
      largest = std::max(largest, (difference.array() / sd.array()).abs().maxCoeff());
      EXPECT_LE((b->standard_deviation().cast<double>() - sd).norm(), 0.01 * sd.norm());
    }
  }
  EXPECT_LE(largest, 0.01);
}

}  // namespace
}  // namespace condyle
