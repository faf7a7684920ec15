// SPDX-License-Identifier: Apache-2.0
#include "consistency/simulated_chewing.h"

#include <random>

namespace condyle::testing_support {

std::vector<DrivenSample> chew(const DrivenTruth& truth, double rate_Hz, unsigned seed,
                               double duration_s) {
  DrivenChewing chewing(truth, rate_Hz, seed);
  std::vector<DrivenSample> samples;
  for (double t = 0; t < duration_s; t += 1 / rate_Hz) samples.push_back(chewing.next());
  return samples;
}

void chew_apart(const DrivenTruth& truth, const ApartRates& rates, unsigned seed,
                const std::vector<DriveTimeline<double>*>& timelines) {
  constexpr double kRate_Hz = 3000, kDuration_s = 30;
  DrivenChewing chewing(truth, kRate_Hz, seed);
  std::mt19937_64 random(seed + 1'000'000);
  std::normal_distribution<double> normal;
  DrivenSample before = chewing.next();
  int drives = 0, positions = 0;
  for (int k = 1; k < static_cast<int>(kDuration_s * kRate_Hz); ++k) {
    const DrivenSample sample = chewing.next();
    const auto at = [&](double time_s, double DrivenSample::*value) {
      const double share = time_s * kRate_Hz - (k - 1);
      return before.*value + share * (sample.*value - before.*value);
    };
    const double now_s = k / kRate_Hz;
    for (double t = drives / rates.drive_Hz; t < now_s; t = ++drives / rates.drive_Hz) {
      const double measured_N = at(t, &DrivenSample::true_drive_N) + kDriveSd_N * normal(random);
      for (auto* const timeline : timelines) {
        timeline->add_drive(nanoseconds(t + rates.drive_delay_s), measured_N);
      }
    }
    const auto next_s = [&] { return rates.first_position_s + positions / rates.position_Hz; };
    for (; next_s() < now_s; ++positions) {
      const double measured_m =
          at(next_s(), &DrivenSample::true_position_m) + kPositionSd_m * normal(random);
      for (auto* const timeline : timelines) {
        timeline->add_position(nanoseconds(next_s()), measured_m, kPositionSd_m);
      }
    }
    before = sample;
  }
}

JointEstimate<double> chew_apart(const DrivenTruth& truth, const ApartRates& rates, unsigned seed,
                                 DriveTimeline<double> timeline) {
  chew_apart(truth, rates, seed, {&timeline});
  return timeline.estimate();
}

}  // namespace condyle::testing_support
