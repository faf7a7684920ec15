// SPDX-License-Identifier: Apache-2.0
// Splits a recording into a part for fitting parameters and a part for checking them.
//
// A recording is cut into stretches of equal length; every third is held out. The filter runs
// through all of them: its predictions in a stretch depend on the stretch before, and its
// innovations there are not fitted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "statistics/chi_square.h"
#include "tuning/innovation_likelihood.h"

namespace condyle::host {

/// A recording and its stretches.
class SplitRecording {
 public:
  explicit SplitRecording(const TuningRecording& recording);

  const TuningRecording& recording() const { return *recording_; }
  std::uint32_t stretch_of(std::size_t sample) const { return stretch_of_[sample]; }
  std::uint32_t stretch_count() const { return stretch_count_; }
  double stretch_s() const { return stretch_s_; }
  static bool is_held_out(std::uint32_t stretch) { return stretch % 3 == 2; }

 private:
  const TuningRecording* recording_;
  double stretch_s_;
  std::vector<std::uint32_t> stretch_of_;
  std::uint32_t stretch_count_ = 0;
};

/// The innovations of one stretch.
struct StretchInnovations {
  std::size_t recording = 0;
  double begin_s = 0;  ///< since the recording's first kept sample, gaps left out
  bool is_held_out = false;
  std::uint64_t count = 0;
  double mean_nis = 0;
  double score = 0;  ///< sum
  // Of samples that the adaptive estimator also scored:
  double advantage = 0;  ///< sum of the differences, this model's less the adaptive estimator's
  std::uint64_t compared = 0;
};

/// Correlation of standardised innovations at a distance in samples.
struct LagCorrelation {
  double value = 0;
  double bound = 0;  ///< 95 % of white innovations are within +- this
};

/// Performance of a model on held-out positions.
struct CrossValidation {
  static constexpr int kLags = 20;

  std::uint64_t count = 0;
  double mean_nis = 0;
  /// 95 %, for white Gaussian innovations and parameters fitted to the other stretches.
  Interval nis_bounds;
  bool nis_inside = false;
  std::vector<LagCorrelation> correlation;  ///< 1 to kLags apart, within stretches
  double whiteness_p = 0;                   ///< probability of such correlations, if they are white
  double beyond_3_sd = 0;                   ///< share; 0.0027 if Gaussian
  double stretch_dispersion = 0;            ///< of the stretches' NIS, 1 if all are alike
  double dispersion_bound = 0;              ///< 95 %, if all are alike
  double score = 0;                         ///< mean
  // Against the adaptive estimator: mean difference of scores and its standard error.
  double advantage = 0, advantage_se = 0;
  std::vector<StretchInnovations> stretches;  ///< also the fitted ones
};

/// Runs the filter of `model` through `recordings`.
CrossValidation cross_validate(const std::vector<SplitRecording>& recordings,
                               const NoiseModel& model, const MotionPriorParameters& prior);

/// Mean difference of held-out scores of two models on the same recordings, with its standard error
/// from stretch to stretch.
struct ScoreDifference {
  double mean = 0, standard_error = 0;
};
ScoreDifference compare_scores(const CrossValidation& one, const CrossValidation& other);

/// Innovations count as white from this probability on.
inline constexpr double kWhite = 0.01;
/// Whether the innovations are white, as text.
std::string whiteness_text(const CrossValidation& check);

/// Why a model with white noise does not explain the held-out positions, strongest reason first;
/// empty if there is none.
std::vector<std::string> reasons_against_white(const std::vector<SplitRecording>& recordings,
                                               const CrossValidation& check);

}  // namespace condyle::host
