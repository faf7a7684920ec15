// SPDX-License-Identifier: Apache-2.0
// Value and slope of a motion at each sample: least squares of a cubic over the samples within a
// window, usually 50 ms on both sides and at least seven of them. A quadratic would give slopes 3 %
// too small at the peak of a chewing stroke. Linear in the samples, with known weights.
#pragma once

#include <cstddef>
#include <vector>

#include "readings/pose_track.h"
#include "readings/sample_run.h"

namespace condyle::host {

/// Half width of the usual window (s), and where samples are few, the greatest half width.
inline constexpr double kFitHalfWidth_s = 0.05, kWidestFit_s = 0.15;
/// Its fewest samples.
inline constexpr std::size_t kLeastFitSamples = 7;

/// Standard deviation of a slope over that of a sample, at the constant rate `rate_Hz` (1/s).
double slope_gain(double rate_Hz);

/// The weights of the fits at samples `begin` to `end` (without) of a recording: over
/// `half_width_s` on both sides, and farther if that has less than `least_samples`.
class LocalFit {
 public:
  LocalFit(const std::vector<double>& time_s, std::size_t begin, std::size_t end,
           double half_width_s = kFitHalfWidth_s, std::size_t least_samples = kLeastFitSamples);

  /// Values and slopes (per s) at all its samples, from the `samples` of the recording from
  /// `first_sample` on; they must contain those of `first_used` to `end_used`.
  void apply(const std::vector<Vector6>& samples, std::size_t first_sample,
             std::vector<Vector6>& values, std::vector<Vector6>& slopes) const {
    apply(samples, first_sample, begin_, end_, values, slopes);
  }
  /// The same at its samples `begin` to `end` (without) only, from what the fits there use.
  void apply(const std::vector<Vector6>& samples, std::size_t first_sample, std::size_t begin,
             std::size_t end, std::vector<Vector6>& values, std::vector<Vector6>& slopes) const;

  /// Variance of each value over that of a sample.
  std::vector<double> gains() const;

  /// The first and the end of the samples that the fits use.
  SampleRun used() const { return used_; }

 private:
  struct Window {
    std::size_t first, count;  // samples of the recording
    std::size_t weights;       // of the first, in weights_
  };
  struct Weights {
    double value, slope;
  };
  std::size_t begin_, end_;
  SampleRun used_;
  std::vector<Window> windows_;
  std::vector<Weights> weights_;
};

/// The samples that the fits at samples `begin` to `end` (without) use.
SampleRun samples_of_fit(const std::vector<double>& time_s, std::size_t begin, std::size_t end,
                         double half_width_s = kFitHalfWidth_s);

/// Slopes of `values` at `time_s`: those of the quartics through five neighbours (Lagrange).
std::vector<Vector6> slopes_of(const std::vector<double>& time_s,
                               const std::vector<Vector6>& values);

/// Part of a motion with its smoothed values.
struct SmoothMotion {
  std::vector<double> time_s;
  std::vector<Vector6> value, slope;
};

}  // namespace condyle::host
