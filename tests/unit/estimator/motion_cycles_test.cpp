// SPDX-License-Identifier: Apache-2.0
// Random chewing gives its cycles, with their reasons if they are not taken.
#include "condyle/estimator/motion/motion_cycles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/random.h"
#include "support/tier.h"

namespace condyle {
namespace {

using testing_support::Random;
using testing_support::runs;

struct TrueCycle {
  double begin_s, turn_s, end_s, height_m;
};

// Strokes of least jerk between rests.
class Chewing {
 public:
  // Random sizes, durations and pauses.
  Chewing(int count, Random& random) {
    rest(1);
    for (int i = 0; i < count; ++i) {
      const double opening_s = 0.2 + 0.4 * random.uniform();
      chew(8e-3 + 12e-3 * random.uniform(), opening_s, 0.2 + 0.4 * random.uniform());
      if (random.uniform() < 0.15) rest(0.7 + 2 * random.uniform());
    }
    rest(1);
  }
  Chewing() { rest(1); }

  void rest(double duration_s) { duration_s_ += duration_s; }
  void chew(double height_m, double opening_s, double closing_s) {
    const double turn_s = duration_s_ + opening_s, end_s = turn_s + closing_s;
    cycles.push_back({duration_s_, turn_s, end_s, height_m});
    duration_s_ = end_s;
  }
  double duration_s() const { return duration_s_; }
  /// Height and rate.
  std::pair<double, double> at(double time_s) const {
    for (const TrueCycle& cycle : cycles) {
      if (time_s < cycle.begin_s || time_s >= cycle.end_s) continue;
      const bool opens = time_s < cycle.turn_s;
      const double begin_s = opens ? cycle.begin_s : cycle.turn_s;
      const double way_s = (opens ? cycle.turn_s : cycle.end_s) - begin_s;
      const double x = (time_s - begin_s) / way_s;
      const double share = x * x * x * (10 - 15 * x + 6 * x * x);
      const double rate = 30 * x * x * (1 - x) * (1 - x) / way_s;
      return opens ? std::pair(-cycle.height_m * share, -cycle.height_m * rate)
                   : std::pair(-cycle.height_m * (1 - share), cycle.height_m * rate);
    }
    return {0, 0};
  }

  std::vector<TrueCycle> cycles;

 private:
  double duration_s_ = 0;
};

constexpr double kHeightSd_m = 2e-5, kRateSd_m_s = 1e-3;

// A time in which the height is hardly known: its standard deviation, and its error over it.
struct Blur {
  double begin_s = 0, end_s = 0, sd_m = 0, error_sds = 0;
  bool is_at(double time_s) const { return time_s >= begin_s && time_s < end_s; }
};

// What a MotionCycles finds in `chewing`, seen at `rate_Hz`, without the samples that `is_lost`.
template <class Scalar, class IsLost>
std::vector<MotionCycle<Scalar>> found_in(const Chewing& chewing, double rate_Hz, Random& random,
                                          const IsLost& is_lost, TimeNs origin_ns = 0,
                                          const Blur& blur = {}) {
  MotionCycles<Scalar> finder;
  MotionCycle<Scalar> cycle;
  std::vector<MotionCycle<Scalar>> found;
  for (double time_s = 0; time_s < chewing.duration_s(); time_s += 1 / rate_Hz) {
    if (is_lost(time_s)) continue;
    const auto [height_m, rate_m_s] = chewing.at(time_s);
    CycleSample<Scalar> sample;
    sample.time_ns = origin_ns + nanoseconds(time_s);
    sample.height_m = static_cast<Scalar>(height_m + kHeightSd_m * random.normal());
    sample.height_sd_m = static_cast<Scalar>(kHeightSd_m);
    sample.rate_m_s = static_cast<Scalar>(rate_m_s + kRateSd_m_s * random.normal());
    sample.speed_m_s = std::abs(sample.rate_m_s);
    sample.rate_sd_m_s = sample.speed_sd_m_s = static_cast<Scalar>(kRateSd_m_s);
    if (blur.is_at(time_s)) {
      sample.height_m += static_cast<Scalar>(blur.error_sds * blur.sd_m);
      sample.height_sd_m = static_cast<Scalar>(blur.sd_m);
    }
    if (finder.add(sample, cycle)) found.push_back(cycle);
  }
  if (finder.finish(cycle)) found.push_back(cycle);
  return found;
}

constexpr auto kNothingLost = [](double) { return false; };

template <class Scalar>
class MotionCyclesTest : public testing::Test {};
using Scalars = testing::Types<double, float>;
TYPED_TEST_SUITE(MotionCyclesTest, Scalars);

TYPED_TEST(MotionCyclesTest, OfRandomChewingAreAllOfItsCycles) {
  double truth = 0, given = 0, right = 0, squares = 0, wide = 0;
  for (std::uint64_t seed = 1; seed <= runs<std::uint64_t>(40, 100, 1000); ++seed) {
    Random random(seed);
    const Chewing chewing(20, random);
    const double rate_Hz = 50 * std::pow(10, random.uniform());
    const auto found = found_in<TypeParam>(chewing, rate_Hz, random, kNothingLost);
    truth += static_cast<double>(chewing.cycles.size());
    TimeNs last_ns = 0;
    for (const auto& cycle : found) {
      EXPECT_LE(last_ns, cycle.begin_ns);
      EXPECT_LT(cycle.begin_ns, cycle.turn_ns);
      EXPECT_LT(cycle.turn_ns, cycle.end_ns);
      EXPECT_LE(cycle.end_ns, cycle.known_ns);
      last_ns = cycle.end_ns;
      given += cycle.verdict == CycleVerdict::taken ? 1 : 0;
    }
    for (const TrueCycle& cycle : chewing.cycles) {
      for (const auto& one : found) {
        if (one.verdict != CycleVerdict::taken ||
            std::abs(seconds(one.begin_ns) - cycle.begin_s) > 0.1 ||
            std::abs(seconds(one.turn_ns) - cycle.turn_s) > 0.1 ||
            std::abs(seconds(one.end_ns) - cycle.end_s) > 0.1) {
          continue;
        }
        ++right;
        const double z = (static_cast<double>(one.duration_s.value) - cycle.end_s + cycle.begin_s) /
                         static_cast<double>(one.duration_s.standard_deviation);
        squares += z * z;
        EXPECT_NEAR(static_cast<double>(one.height_m.value), cycle.height_m,
                    4 * static_cast<double>(one.height_m.standard_deviation));
        // Between samples a peak is missed by its curvature: of a stroke of 0.2 s at 50 Hz by 2 %.
        const double peak_m_s = 1.875 * cycle.height_m / (cycle.turn_s - cycle.begin_s);
        wide += std::abs(static_cast<double>(one.opening_peak_speed_m_s.value) - peak_m_s) >
                0.02 * peak_m_s +
                    2 * static_cast<double>(one.opening_peak_speed_m_s.standard_deviation);
        break;
      }
    }
  }
  EXPECT_GE(right, 0.99 * truth);
  EXPECT_GE(right, 0.99 * given);
  EXPECT_LT(squares, 1.3 * right);
  EXPECT_LT(wide, 0.01 * right);
}

// A gap in a cycle takes this cycle away, no other.
TYPED_TEST(MotionCyclesTest, RejectTheOneWithAGap) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const Chewing chewing(12, random);
    const TrueCycle& hurt = chewing.cycles[5];
    const double gap_s = hurt.begin_s + (hurt.end_s - hurt.begin_s) * 0.3;
    const auto found = found_in<TypeParam>(chewing, 200, random, [&](double time_s) {
      return time_s > gap_s && time_s < gap_s + 0.13;
    });
    ASSERT_EQ(found.size(), chewing.cycles.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].verdict, i == 5 ? CycleVerdict::gap : CycleVerdict::taken) << i;
      EXPECT_EQ(found[i].duration_s.provenance,
                i == 5 ? Provenance::not_computed : Provenance::measured);
    }
    EXPECT_NEAR(seconds(found[5].longest_gap_ns), 0.135, 0.006);
  }
}

// Heights that are hardly known for a moment hide no other cycle.
TYPED_TEST(MotionCyclesTest, AreFoundAfterHeightsThatAreHardlyKnown) {
  for (std::uint64_t seed = 1; seed <= runs<std::uint64_t>(100, 300, 4000); ++seed) {
    Random random(seed);
    const Chewing chewing(14, random);
    const double rate_Hz = 50 * std::pow(10, random.uniform());
    Blur blur;
    blur.begin_s = 0.5 + 0.5 * chewing.duration_s() * random.uniform();
    blur.end_s = blur.begin_s + 1 / rate_Hz + 0.1 * random.uniform();
    blur.sd_m = 1e-4 * std::pow(1000, random.uniform());
    blur.error_sds = std::clamp(random.normal(), -3.0, 3.0);
    const auto found = found_in<TypeParam>(chewing, rate_Hz, random, kNothingLost, 0, blur);
    int touched = 0;
    for (const TrueCycle& cycle : chewing.cycles) {
      bool is_found = false;
      for (const auto& one : found) {
        is_found = is_found || (one.verdict == CycleVerdict::taken &&
                                std::abs(seconds(one.begin_ns) - cycle.begin_s) < 0.1 &&
                                std::abs(seconds(one.turn_ns) - cycle.turn_s) < 0.1 &&
                                std::abs(seconds(one.end_ns) - cycle.end_s) < 0.1);
      }
      // The cycle during the blur, those that share an instant with it, and the one before it: up
      // to 0.5 s after its end decide whether the jaw pauses.
      if (cycle.end_s > blur.begin_s - 0.5 && cycle.begin_s < blur.end_s + 0.1) {
        ++touched;
        continue;
      }
      EXPECT_TRUE(is_found) << "seed " << seed << ", " << rate_Hz << " Hz, blur of "
                            << 1e3 * blur.sd_m << " mm at " << blur.begin_s << " s, off by "
                            << blur.error_sds << " sd; cycle at " << cycle.begin_s << " s";
    }
    EXPECT_LT(touched, 14) << seed;
  }
}

TYPED_TEST(MotionCyclesTest, RejectTooShortAndTooLongOnes) {
  Random random(1);
  Chewing chewing;
  for (int i = 0; i < 8; ++i) chewing.chew(15e-3, 0.3, 0.3);
  chewing.chew(15e-3, 0.1, 0.1);
  chewing.chew(15e-3, 0.3, 0.3);
  chewing.chew(15e-3, 2, 1.5);
  chewing.chew(3e-3, 0.3, 0.3);  // too low to be a cycle
  chewing.rest(1);
  const auto found = found_in<TypeParam>(chewing, 200, random, kNothingLost);
  ASSERT_EQ(found.size(), 11U);
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_EQ(found[i].verdict, i == 8    ? CycleVerdict::too_short
                                : i == 10 ? CycleVerdict::too_long
                                          : CycleVerdict::taken)
        << i;
  }
}

// It gives a cycle before a pause without waiting for the next one.
TYPED_TEST(MotionCyclesTest, ComeWithinTheirPause) {
  Random random(2);
  Chewing chewing;
  for (int i = 0; i < 4; ++i) chewing.chew(12e-3, 0.35, 0.35);
  chewing.rest(5);
  const auto found = found_in<TypeParam>(chewing, 100, random, kNothingLost);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_TRUE(found[0].begins_after_pause);
  EXPECT_TRUE(found[3].ends_with_pause);
  EXPECT_LT(seconds(found[3].known_ns - found[3].end_ns), 0.6);
}

// Neither the origin of time nor the rate of repetition of a sample matters; what is not finite, or
// not later than the last sample, is as if it were not there.
TYPED_TEST(MotionCyclesTest, DependOnNoOriginAndIgnoreWhatIsNotUsable) {
  Random random(3), again(3);
  const Chewing chewing(10, random);
  const Chewing same(10, again);
  const auto found = found_in<TypeParam>(chewing, 200, random, kNothingLost);
  constexpr TimeNs kLate_ns = 1'700'000'000'000'000'000;
  const auto late = found_in<TypeParam>(same, 200, again, kNothingLost, kLate_ns);
  ASSERT_EQ(found.size(), late.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(late[i].end_ns - kLate_ns, found[i].end_ns);
    EXPECT_EQ(late[i].duration_s.value, found[i].duration_s.value);
  }
  MotionCycles<TypeParam> finder;
  MotionCycle<TypeParam> cycle;
  CycleSample<TypeParam> sample;
  sample.height_m = std::numeric_limits<TypeParam>::quiet_NaN();
  EXPECT_FALSE(finder.add(sample, cycle));
  EXPECT_FALSE(finder.finish(cycle));
}

// A recording that stops at any instant holds the cycles that were over by then, and no other.
TYPED_TEST(MotionCyclesTest, OfACutRecordingAreThoseThatWereOver) {
  Random random(4);
  const Chewing chewing(8, random);
  constexpr double kUndecided_s = 0.1;  // around a closed instant
  for (double end_s = 0.3; end_s < chewing.duration_s(); end_s += 0.037) {
    std::size_t over = 0;
    bool is_undecided = false;
    for (const TrueCycle& cycle : chewing.cycles) {
      over += cycle.end_s < end_s ? 1U : 0U;
      is_undecided = is_undecided || std::abs(cycle.end_s - end_s) < kUndecided_s;
    }
    if (is_undecided) continue;
    const auto found = found_in<TypeParam>(chewing, 100, random,
                                           [end_s](double time_s) { return time_s > end_s; });
    EXPECT_EQ(found.size(), over) << end_s;
  }
}

// The closing with which a recording begins has no begin.
TYPED_TEST(MotionCyclesTest, NeedTheirBegin) {
  Random random(5);
  Chewing chewing;
  chewing.chew(12e-3, 0.35, 0.35);
  chewing.rest(0.3);
  const TrueCycle& only = chewing.cycles[0];
  for (const double begin_s : {only.turn_s - 0.1, only.turn_s, only.turn_s + 0.1}) {
    const auto found =
        found_in<TypeParam>(chewing, 100, random, [=](double time_s) { return time_s < begin_s; });
    EXPECT_TRUE(found.empty()) << begin_s;
  }
}

}  // namespace
}  // namespace condyle
