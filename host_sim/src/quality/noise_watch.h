// SPDX-License-Identifier: Apache-2.0
// Whether the noise of one axis is white, as the filter's intervals require.
//
// Smoothing is visible in the remaining noise (innovation_monitor.h). Rounding to a step g adds
// white noise of variance g^2 / 12, which hides it: if rounding causes kRoundedShare of the noise
// or more, smoothing cannot be excluded. Slow noise of an instrument, such as coloured noise and
// vibration, cannot be distinguished from motion by positions alone.
//
// tests/consistency/noise_watch_test.cpp simulates the coverage in these cases: the share of
// samples whose 95 % interval of the position contains the truth, in the worst case.
#pragma once

#include <cmath>

#include "condyle/estimator/math/innovation_monitor.h"
#include "condyle/estimator/motion/rounding_step.h"

namespace condyle::host {

/// Watches one axis. Constant memory.
class NoiseWatch {
 public:
  static constexpr double kRoundedShare = 0.3;
  /// Worst coverage of 95 % intervals of the position (%): for positions smoothed and then rounded;
  /// and for noise with correlations of neighbours up to 0.9, or with a vibration of twice the
  /// noise's standard deviation.
  static constexpr double kWorstSmoothed_percent = 0.3, kWorstSlow_percent = 25;

  /// Adds one sample: the standardised innovation, without unit, and the measured position,
  /// `step_s` after the previous one; NaN if there was none.
  void add(double standardised, double position_m, double step_s) {
    monitor_.add(standardised, position_m, step_s);
    if (std::isfinite(position_m)) rounding_.add(position_m);
  }

  const InnovationMonitor<double>& monitor() const { return monitor_; }
  /// The step that positions are rounded to (m); 0 if there is none.
  double rounding_step_m() const { return rounding_.step_m(); }
  /// True if rounding causes so much of the noise that smoothing would not be detected.
  bool hides_smoothing() const {
    const double step_m = rounding_.step_m(), sd_m = monitor_.noise_sd_m();
    return step_m > 0 && step_m * step_m / 12 >= kRoundedShare * sd_m * sd_m;
  }
  /// True if the noise is not white and rounding is not the reason.
  bool is_filtered() const { return monitor_.is_filtered() && !hides_smoothing(); }
  bool is_correlated() const { return monitor_.is_correlated(); }
  /// True if there is no evidence against the stated intervals.
  bool is_trusted() const {
    return !monitor_.is_filtered() && !is_correlated() && !hides_smoothing();
  }

 private:
  InnovationMonitor<double> monitor_;
  RoundingStep<double> rounding_;
};

}  // namespace condyle::host
