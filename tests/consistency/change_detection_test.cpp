// SPDX-License-Identifier: Apache-2.0
// The damping of single cycles is known as well as is said, a change is detected nearly as soon as
// can be, and false alarms come as rarely as the user wants.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <vector>

#include "condyle/estimator/changes/change_detector.h"
#include "condyle/estimator/changes/cycle_damping.h"
#include "condyle/estimator/impedance/point_identification.h"
#include "statistics/chi_square.h"
#include "support/acceptance.h"
#include "support/driven_chewing.h"
#include "support/random.h"
#include "support/tier.h"

namespace condyle {
namespace {

using testing_support::DrivenChewing;
using testing_support::DrivenTruth;
using testing_support::fewest_hits;
using testing_support::most_mean_ratio;
using testing_support::most_rms_ratio;
using testing_support::runs;

// Identifies a baseline over some time, then gives one cycle after the other.
class CycleSource {
 public:
  CycleSource(const DrivenTruth& truth, double rate_Hz, unsigned seed, double baseline_s)
      : chewing_(truth, rate_Hz, seed), stage_(baseline(baseline_s), parameters(), {}) {}

  CycleReport<double> next() {
    for (;;) {
      const auto sample = chewing_.next();
      const auto report = stage_.step(chewing_.sample_time_s(), sample.drive_N, sample.position_m,
                                      DrivenChewing::kPositionSd_m);
      if (report.outcome == CycleOutcome::counted) return report;
    }
  }
  DrivenChewing& chewing() { return chewing_; }

 private:
  static ImpedanceParameters parameters() {
    ImpedanceParameters parameters;
    parameters.drive.noise_sd_N = DrivenChewing::kDriveSd_N;
    return parameters;
  }
  DampingBaseline baseline(double seconds) {
    PointIdentification<double> identification(parameters());
    TimeNs time_ns = 0;
    for (double t = 0; t < seconds; t += chewing_.sample_time_s()) {
      const auto sample = chewing_.next();
      time_ns += nanoseconds(chewing_.sample_time_s());
      identification.add_drive(time_ns, sample.drive_N);
      identification.add_position(time_ns, sample.position_m);
    }
    identification.conclude();
    return baseline_of(identification.estimate());
  }

  DrivenChewing chewing_;
  CycleDamping<double> stage_;
};

class Cycles : public testing::TestWithParam<double> {};

// A consistent estimate leaves the bounds of each average once in 1000 times. The baseline is off
// by what it is after 60 s, which is the same in all cycles, so that a first part of the error is.
TEST_P(Cycles, AreKnownAsWellAsIsSaidEachForItself) {
  const unsigned kCycles = runs(1000U, 4000U, 4000U);
  const DrivenTruth truth;
  CycleSource source(truth, GetParam(), 1, 60);
  double nees = 0, lag = 0, last = 0, sum = 0, information = 0;
  unsigned covered = 0;
  for (unsigned i = 0; i < kCycles; ++i) {
    const auto cycle = source.next();
    const double error = cycle.friction_Ns_m - truth.friction_Ns_m;
    const double deviation = error / cycle.standard_deviation;
    sum += error / kCycles;
    nees += deviation * deviation / kCycles;
    lag += deviation * last / kCycles;
    last = deviation;
    covered += std::abs(deviation) < kNormalQuantile95 ? 1U : 0U;
    information += 1 / (cycle.standard_deviation * cycle.standard_deviation) / kCycles;
  }
  std::cout << "             " << GetParam() << " Hz: NEES " << nees << ", correlation " << lag
            << ", covered " << 100.0 * covered / kCycles << " %, bias " << sum << " of sd "
            << 1 / std::sqrt(information) << " Ns/m\n";
  EXPECT_TRUE(host::mean_chi_square_bounds(1, kCycles, 0.999).contains(nees));
  EXPECT_LT(std::abs(lag), most_mean_ratio(kCycles, 0.001));
  EXPECT_TRUE(host::proportion_interval(covered, kCycles, 0.999).contains(0.95));
  constexpr double kOfBaseline = 0.047;  // and the chance of 4000 cycles make 0.1
  EXPECT_LT(std::abs(sum),
            (kOfBaseline + most_mean_ratio(kCycles, 0.001)) / std::sqrt(information));
}
INSTANTIATE_TEST_SUITE_P(Rates, Cycles, testing::Values(60, 200));

// At one false alarm in 8 h of chewing at 1.3 Hz; the point changes within a cycle, some time after
// the 60 s from which the detector learns. Lorden's bound is for what the average cycle tells. The
// delay is counted from the change, in cycles chewed; the detector knows of them at their ends.
// Within 1.5 times Lorden's bound 60 % of the changes are noticed (729 of 1200 other seeds): fewer
// than the test asks for, half of 200, once in 333 times. Of 40 seeds it finds a detector that
// notices a third in time in 2 of 3 times. A size as uncertain as is said is off by more than the
// bound once in 1000 times, of 200 seeds once in 10^5.
TEST(ChangeDetection, IsNearlyAsSoonAsCanBe) {
  const unsigned kSeeds = runs(40U, 80U, 200U);
  const ChangeParameters parameters;
  DrivenTruth before, after;
  after.friction_Ns_m = 0.088;
  std::vector<double> delays;
  double information = 0, count = 0, size_squares = 0, first_after = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    CycleSource source(before, 60, seed, 60);
    ChangeDetector<double> detector(parameters);
    while (detector.cycles() < 98) {
      const auto cycle = source.next();
      (void)detector.add(cycle.friction_Ns_m, cycle.standard_deviation);
      information += 1 / (cycle.standard_deviation * cycle.standard_deviation);
      ++count;
    }
    ASSERT_FALSE(detector.is_alarm()) << seed;
    for (unsigned i = 0; i < seed % 45; ++i) (void)source.chewing().next();
    CycleSource changed = source;
    changed.chewing().become(after);
    const double begin = changed.chewing().cycles();
    while (!detector.is_alarm() && changed.chewing().cycles() < begin + 100) {
      const auto cycle = changed.next();
      (void)detector.add(cycle.friction_Ns_m, cycle.standard_deviation);
    }
    ASSERT_EQ(detector.state(), ChangeState::increased) << seed;
    delays.push_back(changed.chewing().cycles() - begin);
    const auto& change = detector.change();
    const double error =
        change.after_Ns_m - change.before_Ns_m - after.friction_Ns_m + before.friction_Ns_m;
    size_squares += error * error /
                    (change.after_sd * change.after_sd + change.before_sd * change.before_sd) /
                    kSeeds;
    first_after += (static_cast<double>(change.first_after) - 98) / kSeeds;
  }
  std::sort(delays.begin(), delays.end());
  const double size = after.friction_Ns_m - before.friction_Ns_m;
  const double bound =
      std::log(parameters.false_alarm_cycles) / (size * size * information / count / 2);
  const double median = delays[kSeeds / 2];
  const auto in_time = static_cast<std::uint64_t>(
      std::lower_bound(delays.begin(), delays.end(), 1.5 * bound) - delays.begin());
  std::cout << "             median " << median << ", in time " << in_time << " of " << kSeeds
            << ", 90 % within " << delays[kSeeds * 9 / 10] << ", longest " << delays.back()
            << " cycles; Lorden's bound " << bound << "; error of the size "
            << std::sqrt(size_squares) << " sd; first cycle after it by " << first_after
            << " too late\n";
  EXPECT_GE(in_time, fewest_hits(kSeeds, 0.6, 0.003));
  EXPECT_LT(std::sqrt(size_squares), std::max(std::sqrt(1.5), most_rms_ratio(kSeeds, 0.001)));
}

struct Alarms {
  double cycles = 0, alarms = 0;
  // Cycles per alarm; relative standard deviation 1 / sqrt(alarms).
  double interval() const { return cycles / alarms; }
};

// What the ratio of the interval to the wanted one keeps to in `expected` alarms, but for
// about `false_alarm`: the logarithm of the number of alarms is nearly normal.
host::Interval interval_bounds(double expected, double false_alarm) {
  const double scatter = host::normal_quantile(1 - false_alarm / 2) / std::sqrt(expected);
  return {std::exp(-scatter), std::exp(scatter)};
}

// Watches sessions of `watched` cycles after the baseline, each until its alarm, until `total`
// cycles have been watched. `source()` begins a session and gives a function for its cycles.
template <class Source>
Alarms watch(const ChangeParameters& parameters, double watched, double total, Source source) {
  Alarms result;
  while (result.cycles < total) {
    auto next = source();
    ChangeDetector<double> detector(parameters);
    const double end = parameters.baseline_cycles + watched;
    while (!detector.is_alarm() && static_cast<double>(detector.cycles()) < end) {
      const CycleReport<double> cycle = next();
      (void)detector.add(cycle.friction_Ns_m, cycle.standard_deviation);
    }
    result.cycles += static_cast<double>(detector.cycles()) - parameters.baseline_cycles;
    result.alarms += detector.is_alarm() ? 1 : 0;
  }
  return result;
}

Alarms watch_normal(const ChangeParameters& parameters, double watched, double total, double sd) {
  testing_support::Random random(1);
  return watch(parameters, watched, total, [&] {
    return [&] {
      CycleReport<double> cycle;
      cycle.friction_Ns_m = sd * random.normal();
      cycle.standard_deviation = 0.0335;
      return cycle;
    };
  });
}

// Normal cycles in sessions of 8 h, with the shortest baseline: about 270 alarms in 10^7, 54 in the
// short form. A detector at the wanted interval leaves the bounds once in some 200 times.
TEST(ChangeDetection, RaisesOneFalseAlarmInEightHours) {
  const ChangeParameters parameters;
  const double cycles = runs(2e6, 1e7, 1e7);
  const Alarms seen = watch_normal(parameters, parameters.false_alarm_cycles, cycles, 0.0335);
  const double ratio = seen.interval() / parameters.false_alarm_cycles;
  std::cout << "             " << seen.alarms << " alarms, interval " << ratio
            << " of the wanted\n";
  EXPECT_TRUE(interval_bounds(cycles / parameters.false_alarm_cycles, 1.0 / 300).contains(ratio));
}

// Whatever the baseline, and with standard deviations that are wrong. A right detector leaves the
// bounds of each of twelve settings once in 500 times; of some 1000 alarms, 200 in the short form.
TEST(ChangeDetection, KeepsTheIntervalWithAnyBaseline) {
  const double cycles = runs(1e5, 5e5, 5e5);
  // It may be 4 % too long.
  const host::Interval bounds = interval_bounds(cycles / 500, 1.0 / 500);
  for (const double baseline_cycles : {20.0, 78.0, 156.0, 390.0}) {
    for (const double sd : {0.0335, 0.02, 0.067}) {
      ChangeParameters parameters;
      parameters.false_alarm_cycles = 500;
      parameters.baseline_cycles = baseline_cycles;
      const double ratio = watch_normal(parameters, 500, cycles, sd).interval() / 500;
      std::cout << "             " << baseline_cycles << " cycles, sd " << sd
                << " said to be 0.0335"
                << ": interval " << ratio << " of the wanted\n";
      EXPECT_GT(ratio, bounds.low) << baseline_cycles << ' ' << sd;
      EXPECT_LT(ratio, 1.04 * bounds.high) << baseline_cycles << ' ' << sd;
    }
  }
}

// Simulated chewing, each session with a baseline of its own: about 200 alarms, 50 in the short
// form. A detector at the interval leaves the bounds once in some 150 times.
TEST(ChangeDetection, KeepsTheIntervalInChewing) {
  ChangeParameters parameters;
  parameters.false_alarm_cycles = 500;
  const double cycles = runs(2.5e4, 5e4, 1e5);
  unsigned seed = 0;
  const Alarms seen = watch(parameters, 2000, cycles, [&] {
    return [source = CycleSource({}, 60, ++seed, 60)]() mutable { return source.next(); };
  });
  const double ratio = seen.interval() / 500;
  std::cout << "             " << seen.alarms << " alarms in " << seed << " sessions, interval "
            << ratio << " of the wanted\n";
  EXPECT_TRUE(interval_bounds(cycles / 500, 1.0 / 190).contains(ratio));
}

}  // namespace
}  // namespace condyle
