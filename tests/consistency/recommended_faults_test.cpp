// SPDX-License-Identifier: Apache-2.0
// Lost samples, glitches, a dropout and a frozen stretch: the velocity in between stays as good.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "consistency/motion_vectors.h"
#include "support/random.h"

namespace condyle {
namespace {

using namespace testing_support;

class RecommendedFaults : public testing::TestWithParam<MotionFile> {};

std::string name_of(const testing::TestParamInfo<MotionFile>& info) {
  return info.param.name;
}
INSTANTIATE_TEST_SUITE_P(Files, RecommendedFaults, testing::ValuesIn(kMotionFiles), name_of);

struct Faulty {
  MotionVector motion;
  std::vector<bool> is_fault;
  std::vector<std::size_t> glitches;

  // Samples without a fault there, in the five before and in the `lag` after, which the estimate
  // also uses.
  std::vector<bool> clean(int lag) const {
    std::vector<bool> is_clean(is_fault.size(), true);
    for (std::size_t i = 0; i < is_fault.size(); ++i) {
      const std::size_t back = std::min(i, static_cast<std::size_t>(lag));
      const std::size_t end = std::min(i + 6, is_fault.size());
      for (std::size_t j = i - back; is_fault[i] && j < end; ++j) is_clean[j] = false;
    }
    return is_clean;
  }
};

// 5 % lost, 1 % glitches of 3 to 8 mm, a dropout of 0.5 s at 20 s, positions repeated from 35 s to
// 36 s; from their third repetition on these are marked, as the device's driver would.
Faulty with_faults(const MotionVector& clean, std::uint64_t seed) {
  Faulty faulty{clean, std::vector<bool>(clean.size(), false), {}};
  MotionVector& motion = faulty.motion;
  Random random(seed);
  std::size_t frozen = 0;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const double t = seconds(motion.time_ns[i]);
    bool is_fault = true;
    if (t >= 20 && t < 20.5) {
      motion.is_measured[i] = false;
    } else if (t >= 35 && t < 36) {
      ++frozen;
      motion.position_m[i] = frozen == 1 ? motion.position_m[i] : motion.position_m[i - 1];
      motion.is_measured[i] = frozen <= 3;  // the first and two repetitions
    } else if (random.uniform() < 0.05) {
      motion.is_measured[i] = false;
    } else if (random.uniform() < 0.01) {
      const double size_m = 3e-3 + 5e-3 * random.uniform();
      motion.position_m[i] += random.uniform() < 0.5 ? size_m : -size_m;
      faulty.glitches.push_back(i);
    } else {
      is_fault = false;
    }
    faulty.is_fault[i] = is_fault;
  }
  return faulty;
}

TEST_P(RecommendedFaults, BetweenThemTheVelocityIsAsGoodAsWithout) {
  const MotionVector clean = read_motion(GetParam().name);
  const Faulty faulty = with_faults(clean, 1);
  ASSERT_GT(faulty.glitches.size(), 20U);
  for (const int lag : kMotionLags) {
    const auto from_clean = estimate_motion<double>({}, lag, clean);
    const auto from_faulty = estimate_motion<double>({}, lag, faulty.motion);
    const auto counts = faulty.clean(lag);
    ASSERT_GT(std::count(counts.begin(), counts.end(), true), 600);
    const double ratio = velocity_error(faulty.motion, from_faulty, kSettled_s, counts) /
                         velocity_error(clean, from_clean, kSettled_s, counts);
    EXPECT_LE(ratio, 1.1) << lag;
    std::cout << "             lag " << lag << ": " << ratio << '\n';
  }
}

TEST_P(RecommendedFaults, EveryGlitchIsNoticedAndNothingIsNaN) {
  const MotionVector clean = read_motion(GetParam().name);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Faulty faulty = with_faults(clean, seed);
    const auto estimates = estimate_motion<double>({}, 0, faulty.motion);
    std::size_t rejected = 0;
    for (const std::size_t i : faulty.glitches) {
      // While it learns the noise, a glitch of 3 mm may still be noise.
      if (seconds(clean.time_ns[i]) < 2) continue;
      const EventSet events = estimates[i].events;
      // The next sample may be the one that shows it.
      std::size_t next = i + 1;
      while (!faulty.motion.is_measured[next]) ++next;
      EXPECT_TRUE(events.has(Event::outlier_rejected) || events.has(Event::outlier_weighted) ||
                  events.has(Event::motion_changed) ||
                  estimates[next].events.has(Event::outlier_revoked))
          << "seed " << seed << " sample " << i;
      rejected += events.has(Event::outlier_rejected);
    }
    std::cout << "             glitches " << faulty.glitches.size() << ", rejected " << rejected
              << '\n';
    for (const auto& estimate : estimates) {
      const auto& axis = estimate.axes[0];
      for (const auto* quantity :
           {&axis.position_m, &axis.velocity_m_s, &axis.acceleration_m_s2, &axis.force_N}) {
        // Nothing is known in the later half of the dropout and of the frozen second.
        ASSERT_EQ(std::isfinite(quantity->value), !estimate.events.has(Event::state_lost));
        ASSERT_EQ(std::isfinite(quantity->standard_deviation), std::isfinite(quantity->value));
      }
    }
  }
}

TEST_P(RecommendedFaults, WithoutThemHardlyASampleIsRejected) {
  const MotionVector clean = read_motion(GetParam().name);
  EventCounts counts;
  for (const auto& estimate : estimate_motion<double>({}, 0, clean)) counts.add(estimate.events);
  EXPECT_LE(static_cast<double>(counts[Event::outlier_rejected]),
            1e-3 * static_cast<double>(clean.size()));
  EXPECT_EQ(counts[Event::state_restarted], 0U);
  std::cout << "             rejected " << counts[Event::outlier_rejected] << ", weighted "
            << counts[Event::outlier_weighted] << " of " << clean.size() << '\n';
}

}  // namespace
}  // namespace condyle
