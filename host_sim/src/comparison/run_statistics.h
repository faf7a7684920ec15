// SPDX-License-Identifier: Apache-2.0
// Statistics of one estimator on one recording, for comparison with others. Constant memory.
//
// Estimators are judged by their predictions of the next measurement; only samples that all of them
// predicted count.
//
//   e, s    innovation, and its standard deviation as predicted
//   score   ln( 0.999 N(e; 0, s^2) + 0.001 / 100 mm ), in 1/mm: the predictive density, with a
//           small chance of any value within 100 mm. This term is the same for all estimators and
//           caps the cost of a glitch at about 14. Higher is better; stating a wrong s does not
//           raise the score on average. Rejected samples count like all others.
//
// For statistics of the motion, only measured values count (provenance.h).
#pragma once

#include <cstdint>

#include "comparison/block_means.h"
#include "comparison/quantile_histogram.h"
#include "condyle/estimator/math/innovation_monitor.h"
#include "estimation/estimate_row.h"
#include "output/figure_data.h"

namespace condyle::host {

/// NaN if a value is not known.
struct RunReport {
  std::uint64_t missing = 0;   ///< samples without a usable position
  std::uint64_t rejected = 0;  ///< samples whose position it rejected
  double measured_share = 0;   ///< of the samples: their velocity is measured

  double error_rms_m = 0, error_median_m = 0;  ///< of the predicted position
  double score = 0;                            ///< mean; see above
  BlockMean score_difference;                  ///< to the baseline's, of the same samples

  double mean_nis = 0;  ///< of the samples not rejected; 1 if s is right
  std::uint64_t nis_samples = 0;
  Interval nis_bounds;     ///< 95 % of such means are within, if s is right
  double correlation = 0;  ///< of neighbouring innovations; 0 if the model holds
  bool is_whiteness_judged = false;
  bool is_correlated = false;  ///< significantly
  bool is_filtered = false;    ///< the noise of the positions is not white

  double range_m = 0;  ///< largest minus smallest estimated position
  double velocity_rms_m_s = 0;
  /// 99 % of the velocities in that direction are smaller.
  double velocity_peak_up_m_s = 0, velocity_peak_down_m_s = 0;
  double velocity_difference_m_s = 0;  ///< rms, to the baseline's at the same instants

  double noise_sd_m = 0;                    ///< rms over the recording; NaN if it is not white
  double jerk_density_m2_s5 = 0;            ///< mean over the recording; likewise
  Quantity<double> friction_Ns_m, mass_kg;  ///< at the end
};

/// Collects the rows of one estimator.
class RunStatistics {
 public:
  /// Share of the velocities in one direction that are below their peak.
  static constexpr double kPeakShare = 0.99;

  /// `block`: samples in a block of score differences (BlockMeans). `estimates_noise`: the
  /// estimator learns noise and jerk from the recording.
  RunStatistics(std::uint64_t block, Axis followed, bool estimates_noise)
      : followed_(followed), estimates_noise_(estimates_noise), score_difference_(block) {}

  /// Takes the row of one sample, `step_s` after the previous one (NaN: not known), and the
  /// baseline's row of the same sample, which may be the same row. `is_compared`: all estimators
  /// have predicted this sample.
  void add(const EstimateRow& row, const EstimateRow& first, double step_s, bool is_compared);
  RunReport report() const;

  /// True if `row` contains a measurement that was predicted.
  bool has_prediction(const EstimateRow& row) const;

 private:
  double score_of(const EstimateRow& row) const;
  double predicted_sd_m(const EstimateRow& row) const;
  int axis_of(const EstimateRow& row) const {
    return row.axis_count == 3 ? static_cast<int>(followed_) : 0;
  }
  void add_motion(const EstimateRow& row, const EstimateRow& first);

  Axis followed_;
  bool estimates_noise_;
  std::uint64_t samples_ = 0, missing_ = 0, rejected_ = 0, at_limit_ = 0;
  Moments error_square_m2_, score_, nis_;
  QuantileHistogram error_m_, up_m_s_, down_m_s_;
  BlockMeans score_difference_;
  InnovationMonitor<double> monitor_;
  std::uint64_t pairs_ = 0;  // of neighbouring innovations
  bool has_previous_ = false;
  Extremes position_m_;
  Moments velocity_square_, velocity_difference_square_, noise_variance_m2_, jerk_;
  Quantity<double> friction_Ns_m_, mass_kg_;
};

}  // namespace condyle::host
