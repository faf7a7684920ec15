// SPDX-License-Identifier: Apache-2.0
// What the noise of one axis says of the intervals that a filter of white noise states.
//
// Smoothing shows in the noise that it leaves (innovation_monitor.h). Rounding to a step g adds
// white noise of variance g^2 / 12, in which that disappears: where rounding makes kRoundedShare of
// the noise or more, smoothing cannot be excluded. Nor can slow noise of an instrument, as coloured
// noise and vibration are, ever be told from motion by its positions.
//
// tests/consistency/noise_watch_test.cpp simulates what an interval is then worth: the share of
// samples whose 95 % interval of the position holds the truth, in the worst of its cases.
#pragma once

#include <cmath>

#include "condyle/estimator/math/innovation_monitor.h"
#include "condyle/estimator/motion/rounding_step.h"

namespace condyle::host {

/// Watches one axis. Constant memory.
class NoiseWatch {
 public:
  static constexpr double kRoundedShare = 0.3;
  /// How many 95 % intervals of the position hold the truth at worst (%): of positions that were
  /// smoothed and then rounded; and with noise whose neighbours are correlated by up to 0.9, or
  /// with a vibration of twice the noise's standard deviation.
  static constexpr double kWorstSmoothed_percent = 0.3, kWorstSlow_percent = 25;

  /// Adds what one sample said: the standardised innovation, no unit, and the measured position,
  /// `step_s` after the one before; NaN if there was none.
  void add(double standardised, double position_m, double step_s) {
    monitor_.add(standardised, position_m, step_s);
    if (std::isfinite(position_m)) rounding_.add(position_m);
  }

  const InnovationMonitor<double>& monitor() const { return monitor_; }
  /// The step that positions are rounded to (m); 0 if there is none.
  double rounding_step_m() const { return rounding_.step_m(); }
  /// True if rounding makes so much of the noise that smoothing would not show.
  bool hides_smoothing() const {
    const double step_m = rounding_.step_m(), sd_m = monitor_.noise_sd_m();
    return step_m > 0 && step_m * step_m / 12 >= kRoundedShare * sd_m * sd_m;
  }
  /// True if the noise is not white and rounding is not the reason.
  bool is_filtered() const { return monitor_.is_filtered() && !hides_smoothing(); }
  bool is_correlated() const { return monitor_.is_correlated(); }
  /// True if nothing speaks against the stated intervals.
  bool is_trusted() const {
    return !monitor_.is_filtered() && !is_correlated() && !hides_smoothing();
  }

 private:
  InnovationMonitor<double> monitor_;
  RoundingStep<double> rounding_;
};

}  // namespace condyle::host
