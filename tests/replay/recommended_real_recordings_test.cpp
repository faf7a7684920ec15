// SPDX-License-Identifier: Apache-2.0
// The recommended estimator on real recordings, all three axes at once. The recordings are not part
// of the project: without CONDYLE_REFERENCE_DATA these tests skip.
#include <gtest/gtest.h>

#include <iostream>

#include "condyle/estimator/motion/recommended_estimator.h"
#include "recordings/recording.h"
#include "support/table.h"

namespace condyle {
namespace {

using testing_support::reference_data;

class RecommendedRealRecordings : public testing::Test {
 protected:
  void SetUp() override {
    if (reference_data("zebris_jma/JMA_position.txt").empty()) {
      GTEST_SKIP() << "set CONDYLE_REFERENCE_DATA to the folder of reference data";
    }
  }
};

// The first point's axes; not measured where the sample is missing or filled with zeros.
std::vector<TimedPosition<double, 3>> read_point(const std::string& name) {
  const auto recording = host::open_recording(reference_data(name), {});
  std::vector<TimedPosition<double, 3>> samples;
  Sample sample;
  SampleChecker checker;
  while (recording->next(sample)) {
    TimedPosition<double, 3> measured{sample.time_ns, true, {}, checker.check(sample)};
    measured.is_measured =
        !measured.events.has(Event::position_missing) && !measured.events.has(Event::zero_filled);
    for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
      measured.position_m[static_cast<int>(axis)] = followed_position_m(sample, {1, axis});
    }
    samples.push_back(measured);
  }
  return samples;
}

template <class Scalar>
std::vector<RecommendedEstimate<Scalar>> estimate(
    const std::vector<TimedPosition<double, 3>>& samples, int lag = 0) {
  RecommendedEstimator<Scalar, 3> estimator({}, lag);
  std::vector<RecommendedEstimate<Scalar>> estimates;
  for (const auto& sample : samples) {
    TimedPosition<Scalar, 3> measured{sample.time_ns, sample.is_measured, {}, sample.events};
    for (int axis = 0; axis < 3; ++axis) {
      measured.position_m[axis] = static_cast<Scalar>(sample.position_m[axis]);
    }
    const auto one = estimator.step(measured);
    if (one.is_ready) estimates.push_back(one);
  }
  RecommendedEstimate<Scalar> left;
  while (estimator.drain(left)) estimates.push_back(left);
  return estimates;
}

// The fastest along each axis (m/s); a value is missing only where the estimator says why.
template <class Scalar>
std::array<double, 3> fastest(const std::vector<RecommendedEstimate<Scalar>>& estimates) {
  std::array<double, 3> speed_m_s{};
  EventCounts counts;
  for (const auto& one : estimates) {
    counts.add(one.events);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto velocity_m_s = static_cast<double>(one.axes[axis].velocity_m_s.value);
      EXPECT_EQ(std::isfinite(velocity_m_s), !one.events.has(Event::state_lost));
      if (std::isfinite(velocity_m_s)) {
        speed_m_s[axis] = std::max(speed_m_s[axis], std::abs(velocity_m_s));
      }
    }
  }
  std::cout << "             fastest " << speed_m_s[0] << " " << speed_m_s[1] << " " << speed_m_s[2]
            << " m/s, weighted " << counts[Event::outlier_weighted] << ", rejected "
            << counts[Event::outlier_rejected] << ", restarted " << counts[Event::state_restarted]
            << ", lost " << counts[Event::state_lost] << ", at limit "
            << counts[Event::noise_at_limit] << ", noise " << estimates.back().axes[2].noise_sd_m
            << " m\n";
  return speed_m_s;
}

constexpr double kFastestJaw_m_s = 0.15;
constexpr int kLags[] = {0, 3, 10, 16};

TEST_F(RecommendedRealRecordings, ZebrisGlitchesMakeNoVelocity) {
  const auto samples = read_point("zebris_jma/JMA_position.txt");
  ASSERT_EQ(samples.size(), 634U);
  for (const int lag : kLags) {
    const auto estimates = estimate<double>(samples, lag);
    for (const double speed_m_s : fastest(estimates)) EXPECT_LT(speed_m_s, kFastestJaw_m_s) << lag;
    EventCounts counts;
    for (const auto& one : estimates) {
      const double t = seconds(one.time_ns);
      if (t > 8.91 && t < 8.99) counts.add(one.events);
    }
    EXPECT_GE(counts[Event::outlier_rejected] + counts[Event::motion_changed] +
                  counts[Event::outlier_weighted],
              2U);
  }
}

// After a second of rest the jaw closes: that is motion and no glitch, and taken for one at most
// for a sample at a time. Its maker smoothed the recording, so that differences of neighbours show
// the velocity to some mm/s.
TEST_F(RecommendedRealRecordings, ZebrisMotionAfterRestIsFollowed) {
  const auto samples = read_point("zebris_jma/JMA_position.txt");
  const auto estimates = estimate<double>(samples);
  int rejected = 0, far_off = 0;
  double worst_m_s = 0;
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const double t = seconds(samples[i].time_ns);
    if (t > 8.9 && t < 9) continue;  // the glitches
    rejected += estimates[i].events.has(Event::outlier_rejected);
    if (estimates[i].events.has(Event::state_restarted)) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double difference_m_s =
          (samples[i + 1].position_m[axis] - samples[i - 1].position_m[axis]) / 0.04;
      const double velocity_m_s = estimates[i].axes[axis].velocity_m_s.value;
      worst_m_s = std::max(worst_m_s, std::abs(velocity_m_s - difference_m_s));
      far_off += std::abs(velocity_m_s - difference_m_s) > 0.03;
    }
  }
  EXPECT_LE(rejected, 2);
  EXPECT_LT(worst_m_s, 0.08);
  EXPECT_LE(far_off, 6) << "of 1899 values";
  std::cout << "             rejected " << rejected << ", velocity off by " << worst_m_s << '\n';
}

TEST_F(RecommendedRealRecordings, SpeechEndsWhereItIsFilledWithZeros) {
  const auto samples = read_point("ema_jaw/0020.jaw");
  ASSERT_EQ(samples.size(), 800U);
  for (const int lag : kLags) {
    const auto estimates = estimate<double>(samples, lag);
    for (const double speed_m_s : fastest(estimates)) EXPECT_LT(speed_m_s, kFastestJaw_m_s) << lag;
    EventCounts counts;
    for (const auto& one : estimates) counts.add(one.events);
    EXPECT_EQ(counts[Event::position_missing], 40U);
    EXPECT_NE(estimates.back().axes[2].position_m.provenance, Provenance::measured);
  }
}

TEST_F(RecommendedRealRecordings, SlowMotionAtUnevenStepsIsSlow) {
  const auto samples = read_point("jaws3d/jawPosition.txt");
  ASSERT_EQ(samples.size(), 1017U);
  for (const int lag : kLags) {
    for (const double speed_m_s : fastest(estimate<double>(samples, lag))) {
      EXPECT_LT(speed_m_s, kFastestJaw_m_s) << lag;
    }
  }
}

// Rms of the difference, and the largest, in units of the column's rms. With a lag, float gives
// filtered instead of smoothed values where its digits do not suffice, just after a start.
TEST_F(RecommendedRealRecordings, FloatIsDouble) {
  for (const char* name :
       {"zebris_jma/JMA_position.txt", "ema_jaw/0020.jaw", "jaws3d/jawPosition.txt"}) {
    for (const int lag : {0, 10}) {
      const auto samples = read_point(name);
      const auto in_double = estimate<double>(samples, lag);
      const auto in_float = estimate<float>(samples, lag);
      ASSERT_EQ(in_float.size(), in_double.size());
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double worst[3] = {}, difference_square[3] = {}, square[3] = {}, count = 0;
        int missing = 0;
        for (std::size_t i = lag == 0 ? 0 : 16; i < in_double.size(); ++i) {
          const auto& a = in_float[i].axes[axis];
          const auto& b = in_double[i].axes[axis];
          const float one[] = {a.position_m.value, a.velocity_m_s.value, a.acceleration_m_s2.value};
          const double other[] = {b.position_m.value, b.velocity_m_s.value,
                                  b.acceleration_m_s2.value};
          if (!std::isfinite(other[0])) continue;
          ++count;
          for (int j = 0; j < 3; ++j) {
            if (!std::isfinite(one[j])) {
              ++missing;
              continue;
            }
            const double difference = std::abs(static_cast<double>(one[j]) - other[j]);
            worst[j] = std::max(worst[j], difference);
            difference_square[j] += difference * difference;
            square[j] += other[j] * other[j];
          }
        }
        EXPECT_EQ(missing, 0) << name << " axis " << axis << " lag " << lag;
        std::cout << "             " << name << " lag " << lag << ":";
        for (int j = 0; j < 3; ++j) {
          const double ratio = std::sqrt(difference_square[j] / square[j]);
          const double largest = worst[j] / std::sqrt(square[j] / count);
          EXPECT_LT(ratio, 1e-3) << name << " axis " << axis << " state " << j << " lag " << lag;
          EXPECT_LT(largest, 2e-2) << name << " axis " << axis << " state " << j << " lag " << lag;
          std::cout << " " << ratio << " (" << largest << ")";
        }
        std::cout << '\n';
      }
    }
  }
}

}  // namespace
}  // namespace condyle
