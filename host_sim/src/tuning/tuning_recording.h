// SPDX-License-Identifier: Apache-2.0
// A recording for tuning: the positions that an estimator would use, in bounded memory.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "condyle/estimator/sample.h"
#include "condyle/estimator/sensors/recommended_parameters.h"
#include "recordings/recording_choice.h"

namespace condyle::host {

/// One sample of a stretch.
struct TuningSample {
  double step_s = 0;  ///< since the sample before; 0 where a stretch begins
  /// Along the followed axis; NaN if there is none, or it was an outlier.
  double position_m = std::numeric_limits<double>::quiet_NaN();
  /// Score of the adaptive estimator's innovation (innovation_likelihood.h); NaN if there is
  /// none.
  double adaptive_score = std::numeric_limits<double>::quiet_NaN();
};

/// Stores at most a given number of samples of a sequence of unknown length: if they become too
/// many, it drops every second stretch, and then stores half as many.
class StretchKeeper {
 public:
  static constexpr std::size_t kStretch = 512;

  /// `most`: at least 2 kStretch.
  explicit StretchKeeper(std::size_t most) : most_(most) {}

  void add(TuningSample sample);
  std::vector<TuningSample> take() { return std::move(samples_); }
  std::uint64_t seen() const { return seen_; }

 private:
  void thin();

  std::size_t most_;
  std::uint64_t seen_ = 0, stride_ = 1;  // one of `stride_` stretches is stored
  std::vector<TuningSample> samples_;
};

/// The data of a recording for tuning.
struct TuningRecording {
  std::string name;
  std::string format;
  std::vector<std::string> notes;
  std::vector<TuningSample> samples;
  std::uint64_t seen = 0;       ///< samples in the recording
  std::uint64_t rejected = 0;   ///< outliers among them
  std::size_t usable = 0;       ///< positions kept
  std::size_t innovations = 0;  ///< of these, counted ones (innovation_likelihood.h)
  double median_step_s = 0;
  /// Distance in samples at which the noise differs most from white noise; 0: no evidence of a
  /// difference.
  int filtered_lag = 0;
  /// Correlation of neighbouring sixth differences, -6/7 for white noise (innovation_monitor.h).
  double neighbours = 0;
};

/// Options of reading recordings.
struct TuningInput {
  RecordingChoice choice;
  std::size_t most_samples = 0;      ///< of each recording, at least 2 StretchKeeper::kStretch
  RecommendedParameters parameters;  ///< of the adaptive estimator that finds the outliers
};

/// Fewest innovations of a usable recording.
inline constexpr std::size_t kFewestTuned = 200;

/// Reads `path`. Throws InputError if it cannot be read, has too few positions, or if they do not
/// vary. Calls `show(share)`, 0 to 1, during the work; `should_stop()` may end it.
TuningRecording read_for_tuning(const std::string& path, const TuningInput& input,
                                const std::function<void(double)>& show,
                                const std::function<bool()>& should_stop);

}  // namespace condyle::host
