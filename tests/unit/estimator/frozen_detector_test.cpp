// SPDX-License-Identifier: Apache-2.0
// Seeds are fixed, so a test either always passes or always fails; a bound states how often a right
// detector under a random seed would exceed it, or that it is a measurement.
#include "condyle/estimator/motion/frozen_detector.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "support/random.h"
#include "support/rapidcheck_gtest.h"
#include "unit/estimator/zebris_points.h"

namespace condyle {
namespace {

using testing_support::Random;
using Point = std::array<double, 3>;

double rounded(double value, double step) {
  return step > 0 ? std::round(value / step) * step : value;
}

// 4 s of chewing at 1.25 Hz, 20 mm deep, then `rest_s` at rest, and again; metres.
class Chewing {
 public:
  Chewing(double rate_Hz, double rest_s, double noise_m, double rounding_m, std::uint64_t seed)
      : rate_Hz_(rate_Hz),
        rest_s_(rest_s),
        noise_m_(noise_m),
        rounding_m_(rounding_m),
        random_(seed) {}

  bool rests() const { return time_s() >= 4; }

  Point next() {
    const double open = rests() ? 0 : 0.5 * (1 - std::cos(2.5 * std::numbers::pi * time_s()));
    Point point = {0.1 + 0.004 * open, 0.1 + 0.006 * open, 0.1 - 0.02 * open};
    for (std::size_t i = 0; i < 3; ++i) {
      point[i] = rounded(point[i] + rest_at_[i] + noise_m_ * random_.normal(), rounding_m_);
    }
    if (++sample_ >= (4 + rest_s_) * rate_Hz_) {
      sample_ = 0;  // the next rest is elsewhere
      for (double& at : rest_at_) at = 1e-5 * random_.uniform();
    }
    return point;
  }

 private:
  double time_s() const { return sample_ / rate_Hz_; }

  double rate_Hz_, rest_s_, noise_m_, rounding_m_;
  Random random_;
  Point rest_at_ = {};  // beside 0.1
  int sample_ = 0;
};

// Number of frozen samples among `count` repeats of one new value.
int frozen_among(FrozenDetector& detector, int count, double& value) {
  value += 1;
  int frozen = 0;
  for (int i = 0; i <= count; ++i) frozen += detector.add({&value, 1}) ? 1 : 0;
  return frozen;
}

// A detector that has seen motion only: f is below its floor.
FrozenDetector after_motion(double& value) {
  FrozenDetector detector;
  for (int i = 0; i < 3000; ++i) EXPECT_EQ(frozen_among(detector, 0, value), 0);
  return detector;
}

// 20 minutes each. Two of the first kind never agree; of the second, four repeats in a row have the
// probability 1e-23.
TEST(FrozenDetector, LeavesNoisyChewingAlone) {
  for (const double rate_Hz : {60.0, 200.0}) {
    for (const double rounding_m : {0.0, 1e-6}) {
      Chewing chewing(rate_Hz, 2, 20e-6, rounding_m, 1);
      FrozenDetector detector;
      for (int i = 0; i < 1200 * rate_Hz; ++i) ASSERT_FALSE(detector.add(chewing.next())) << i;
    }
  }
}

TEST(FrozenDetector, NoticesAFreezeFromTheFourthRepeatToItsEnd) {
  for (const double rate_Hz : {60.0, 200.0}) {
    Chewing chewing(rate_Hz, 2, 20e-6, 1e-6, 2);
    FrozenDetector detector;
    for (int freeze = 0; freeze < 20; ++freeze) {
      // A minute and a bit: another phase of chewing each time, and the last freeze is forgotten.
      for (int i = 0; i < 60 * rate_Hz + 7 * freeze; ++i) {
        ASSERT_FALSE(detector.add(chewing.next())) << freeze << " " << i;
      }
      const Point last = chewing.next();
      ASSERT_FALSE(detector.add(last));
      for (int repeat = 1; repeat <= rate_Hz; ++repeat) {
        ASSERT_EQ(detector.add(last), repeat >= 4) << repeat;
      }
      ASSERT_FALSE(detector.add(chewing.next())) << "the first that differs";
    }
  }
}

// What rest has taught delays the notice. A measurement: at the 8th to 26th repeat.
TEST(FrozenDetector, NoticesAFreezeOfARoundedSignalLater) {
  for (const double rate_Hz : {60.0, 200.0}) {
    Chewing chewing(rate_Hz, 2, 3e-6, 1e-5, 5);
    FrozenDetector detector;
    for (int freeze = 0; freeze < 20; ++freeze) {
      Point last = {};
      for (int i = 0; i < 60 * rate_Hz + 7 * freeze; ++i) {
        last = chewing.next();
        static_cast<void>(detector.add(last));
      }
      int noticed_at = 0;
      for (int repeat = 1; repeat <= rate_Hz; ++repeat) {
        const bool is_frozen = detector.add(last);
        if (is_frozen && noticed_at == 0) noticed_at = repeat;
        ASSERT_EQ(is_frozen, noticed_at > 0) << "to its end";
      }
      EXPECT_GE(noticed_at, 4);
      EXPECT_LE(noticed_at, 50);
      RecordProperty("noticed_at_" + std::to_string(rate_Hz) + "_" + std::to_string(freeze),
                     noticed_at);
    }
  }
}

// The model itself, repeats independent with probability q. A run is called frozen with probability
// 1e-6 at most, but for the error of f: in a million samples 0.1 to 1 on average, as 50 seeds of
// each q have shown. Poisson: one of the five is 10 or more once in 1.8 million seeds.
TEST(FrozenDetector, KeepsItsFalseAlarmProbabilityForIndependentRepeats) {
  for (const double q : {0.02, 0.1, 0.3, 0.7, 0.9}) {
    Random random(3);
    FrozenDetector detector;
    double value = 0;
    int frozen_runs = 0;
    bool was_frozen = false;
    for (int i = 0; i < 1'000'000; ++i) {
      if (random.uniform() >= q) value += 1;
      const bool is_frozen = detector.add({&value, 1});
      if (i > 3000 && is_frozen && !was_frozen) ++frozen_runs;
      was_frozen = is_frozen;
    }
    EXPECT_LT(frozen_runs, 10) << q;
    // Its standard deviation over 500 forgotten changes is (1 - q) / sqrt(1000). 6 of them: 2e-9.
    EXPECT_NEAR(detector.repeat_rate(), q, 6 * (1 - q) / std::sqrt(1000.0));
    RecordProperty("frozen_runs_at_" + std::to_string(q), frozen_runs);
  }
}

// A measurement, not a probability: 4 s of chewing and 4 s of rest in turn, rounded to 10 um, 3
// coordinates, 100 times each. Share of the samples at rest that were called frozen, at 60 / 200
// Hz: noise 3 um 0.025 / 0.016 %, 2 um 0.8 / 0.25 %, 1 um 15 / 10 %; without noise 7 / 99 %: that
// rest is frozen for all that can be seen. The bounds leave room for another library's random
// numbers.
TEST(FrozenDetector, SeldomTakesRoundedRestForAFreeze) {
  struct Case {
    double noise_m, most_share;
  };
  for (const double rate_Hz : {60.0, 200.0}) {
    for (const Case& c : {Case{3e-6, 0.001}, Case{2e-6, 0.02}, Case{1e-6, 0.25}, Case{0, 1}}) {
      Chewing chewing(rate_Hz, 4, c.noise_m, 1e-5, 4);
      FrozenDetector detector;
      int at_rest = 0, frozen_at_rest = 0, in_motion = 0, frozen_in_motion = 0;
      for (int i = 0; i < 800 * rate_Hz; ++i) {
        const bool rests = chewing.rests();
        const bool is_frozen = detector.add(chewing.next());
        (rests ? at_rest : in_motion) += 1;
        (rests ? frozen_at_rest : frozen_in_motion) += is_frozen ? 1 : 0;
      }
      const double share = static_cast<double>(frozen_at_rest) / at_rest;
      EXPECT_LE(share, c.most_share) << rate_Hz << " Hz, noise " << c.noise_m;
      EXPECT_LE(frozen_in_motion, 0.001 * in_motion);
      RecordProperty(
          "share_at_" + std::to_string(rate_Hz) + "_Hz_" + std::to_string(c.noise_m * 1e6) + "_um",
          std::to_string(share));
    }
  }
}

// What the header says of rest after motion with a change every n samples.
TEST(FrozenDetector, LearnsThatTheJawRests) {
  struct Case {
    int n, last_frozen_run;
  };
  for (const Case& c : {Case{10, 0}, Case{30, 30}, Case{100, 300}, Case{1000, 7000}}) {
    double value = 0;
    FrozenDetector detector = after_motion(value);
    int last = -1;
    for (int begin = 0; begin < 100'000; begin += c.n) {
      if (frozen_among(detector, c.n - 1, value) > 0) last = begin;
    }
    EXPECT_EQ(last, c.last_frozen_run) << c.n;
  }
}

TEST(FrozenDetector, UnlearnsAFreeze) {
  double value = 0;
  FrozenDetector detector = after_motion(value);
  EXPECT_EQ(frozen_among(detector, 1000, value), 997);
  struct Case {
    int changes, next_noticed_at;
  };
  for (const Case& c : {Case{1, 18}, Case{1000, 7}, Case{2000, 4}}) {
    FrozenDetector later = detector;
    for (int i = 0; i < c.changes; ++i) EXPECT_EQ(frozen_among(later, 0, value), 0);
    EXPECT_EQ(frozen_among(later, 100, value), 101 - c.next_noticed_at) << c.changes;
  }
  for (int freeze = 0; freeze < 10; ++freeze) {
    for (int i = 0; i < 300; ++i) EXPECT_EQ(frozen_among(detector, 0, value), 0);
    EXPECT_EQ(frozen_among(detector, 100, value) == 0, freeze == 9) << freeze;
  }
}

TEST(FrozenDetector, NeedsTwentyRepeatsAtTheStart) {
  double value = 0;
  FrozenDetector detector;
  EXPECT_EQ(frozen_among(detector, 100, value), 81);
}

TEST(FrozenDetector, DoubtsTheFirstRepeatOfANoisySignal) {
  FrozenDetector detector;
  double value = 0;
  for (; value < 300; ++value) {
    ASSERT_FALSE(detector.add(Point{0, 0, value}));
    ASSERT_EQ(detector.repeats(), 0);
    ASSERT_FALSE(detector.is_doubtful());
  }
  ASSERT_FALSE(detector.add(Point{0, 0, value}));
  EXPECT_FALSE(detector.add(Point{0, 0, value}));
  EXPECT_EQ(detector.repeats(), 1);
  EXPECT_TRUE(detector.is_doubtful());
}

TEST(FrozenDetector, DoubtsNoRepeatOfADeviceThatRepeatsItself) {
  FrozenDetector detector;
  double value = 0;
  for (int i = 0; i < 300; ++i) {
    ASSERT_FALSE(detector.add(Point{0, 0, value}));
    ASSERT_FALSE(detector.is_doubtful());
    if (i % 3 == 0) ++value;
  }
}

RC_GTEST_PROP(FrozenDetector, NeverCallsAChangeOrAThirdRepeatFrozen, ()) {
  FrozenDetector detector;
  int last = -1, repeats = 0;
  for (const int value :
       *rc::gen::resize(400, rc::gen::container<std::vector<int>>(
                                 rc::gen::weightedElement<int>({{1, 0}, {20, 1}})))) {
    repeats = value == last ? repeats + 1 : 0;
    last = value;
    const double coordinates[] = {0.1, 0.01 * value};
    const bool is_frozen = detector.add(coordinates);
    RC_ASSERT(!is_frozen || repeats > 3);
    RC_ASSERT(detector.repeat_rate() >= 0 && detector.repeat_rate() < 1);
  }
}

TEST(FrozenDetector, ComparesBitsAndOnlyNumbers) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  FrozenDetector detector;
  for (const double bad : {nan, infinity, -infinity}) {
    for (int i = 0; i < 100; ++i) ASSERT_FALSE(detector.add(Point{0, 0, bad}));
  }
  for (int i = 0; i < 100; ++i) ASSERT_FALSE(detector.add(std::span<const double>()));
  EXPECT_EQ(detector.repeat_rate(), 0.5) << "they teach nothing";
  for (int i = 0; i < 100; ++i) ASSERT_FALSE(detector.add(Point{0, 0, i % 2 == 0 ? 0.0 : -0.0}));
  const std::array<double, 2> two = {};
  const Point three = {};
  for (int i = 0; i < 50; ++i) {
    ASSERT_FALSE(detector.add(two));
    ASSERT_FALSE(detector.add(three)) << "as many coordinates as before";
  }
}

TEST(FrozenDetector, TakesSamplesWithAllTheirCoordinates) {
  FrozenDetector detector;
  Sample sample;
  sample.kind = SampleKind::three_points;
  for (int i = 0; i < 1000; ++i) {
    sample.coordinates[8] = i;
    ASSERT_FALSE(detector.add(sample));
  }
  for (int repeat = 1; repeat < 10; ++repeat) {
    sample.time_ns += 1000;
    ASSERT_EQ(detector.add(sample), repeat >= 4);
  }
  sample.position_valid = false;
  EXPECT_FALSE(detector.add(sample));
  sample.position_valid = true;
  EXPECT_FALSE(detector.add(sample)) << "nothing to compare with";
}

// Smoothed by its maker, at rest in the end, with runs of up to 10 repeats.
TEST(FrozenDetector, LeavesARealRecordingAlone) {
  const auto samples = testing_support::zebris_samples();
  if (samples.empty()) GTEST_SKIP() << "set CONDYLE_REFERENCE_DATA to the folder of reference data";
  FrozenDetector detector;
  for (std::size_t i = 0; i < samples.size(); ++i) EXPECT_FALSE(detector.add(samples[i])) << i;
}

}  // namespace
}  // namespace condyle
