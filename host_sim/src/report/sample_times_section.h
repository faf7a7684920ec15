// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace condyle::host {

/// What the times of usable samples show about a recording.
struct SampleTimes {
  /// A time without usable samples that is longer than kGap usual steps.
  struct Gap {
    double begin_s, end_s;
  };
  static constexpr double kGap = 1.5;

  double begin_s = 0, end_s = 0;
  double usual_step_s = 0;           ///< the median
  double low_step_s, high_step_s;    ///< ends of the middle 95 % of the steps
  std::vector<std::size_t> heights;  ///< steps in bins of kBin usual steps, from 0 to kWidest
  std::size_t longer = 0;            ///< steps beyond the bins
  std::vector<Gap> gaps;
  double missing_s = 0, longest_gap_s = 0;  ///< time in gaps, without one usual step each

  static constexpr double kBin = 0.05, kWidest = 3;
};

/// Of ascending times (s).
SampleTimes sample_times(const std::vector<double>& time_s);

/// Histogram of the steps and strip of the gaps. `time_s`: of the usable samples, shown less
/// `origin_s`. Nothing of fewer than three samples.
std::string sample_times_html(const std::vector<double>& time_s, double origin_s);

}  // namespace condyle::host
