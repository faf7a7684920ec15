// SPDX-License-Identifier: Apache-2.0
// What tuning keeps of a recording: the positions that an estimator would take, in bounded memory.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "condyle/estimator/sample.h"
#include "condyle/estimator/sensors/recommended_parameters.h"
#include "options/recording_choice.h"

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

/// Keeps at most a given number of samples of a sequence whose end is not known: where they become
/// too many, every second stretch is dropped and from then on as many fewer are taken.
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
  std::uint64_t seen_ = 0, stride_ = 1;  // of `stride_` stretches one is kept
  std::vector<TuningSample> samples_;
};

/// A recording as tuning uses it.
struct TuningRecording {
  std::string name;
  std::string format;
  std::vector<std::string> notes;
  std::vector<TuningSample> samples;
  std::uint64_t seen = 0;       ///< samples in the recording
  std::uint64_t rejected = 0;   ///< outliers among them
  std::size_t usable = 0;       ///< positions kept
  std::size_t innovations = 0;  ///< of these, that count (innovation_likelihood.h)
  double median_step_s = 0;
  /// Samples apart at which the noise is most unlike white noise; 0: nothing shows that it is not.
  int filtered_lag = 0;
  /// Correlation of neighbouring sixth differences, -6/7 for white noise (innovation_monitor.h).
  double neighbours = 0;
};

/// How recordings are read.
struct TuningInput {
  RecordingChoice choice;
  std::size_t most_samples = 0;      ///< of each recording, at least 2 StretchKeeper::kStretch
  RecommendedParameters parameters;  ///< of the adaptive estimator that finds the outliers
};

/// Fewest innovations of a recording that it is tuned with.
inline constexpr std::size_t kFewestTuned = 200;

/// Reads `path`. Throws InputError if it cannot be read, has too few positions, or where they do
/// not vary. `show(share)`, 0 to 1, is called on the way; `should_stop()` may end it.
TuningRecording read_for_tuning(const std::string& path, const TuningInput& input,
                                const std::function<void(double)>& show,
                                const std::function<bool()>& should_stop);

}  // namespace condyle::host
