// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "condyle/estimator/sample.h"
#include "hosted/config/parameter_file.h"
#include "recordings/recording.h"

namespace condyle::host {

/// The user's choice of an estimator.
struct EstimatorChoice {
  std::string name = "recommended";  ///< or "published"
  std::string parameters;            ///< TOML file; empty: see parameters_toml
  int lag = 0;                       ///< samples
  std::string parameters_toml;       ///< the text of such a file; empty: the defaults

  bool is_published() const { return name == "published"; }
  /// Throws InputError if `option`, which only the recommended estimator has, is `given` to the
  /// published cascade. `chosen_by`: the option that chose it.
  void refuse_if_published(const char* option, bool given,
                           const char* chosen_by = "--estimator") const;

  /// The parameters, each for its estimator.
  LoadedParameters load_published() const;
  RecommendedParameters load_recommended() const;
};

/// The recommended estimator's parameters for the recording `source`: those stored in the
/// recording, if it has them and no file is given.
RecommendedParameters load_recommended_for(const EstimatorChoice& estimator,
                                           const RecordingInfo& info, const std::string& source);

/// The published cascade's parameters for samples `step_ns` apart, if the file does not give
/// sample_time_s. Throws an InputError that names `source` if `step_ns` is absent or not a usable
/// sample time.
PublishedParameters load_published_for(const EstimatorChoice& estimator,
                                       std::optional<TimeNs> step_ns, const std::string& source);

/// What to do where the times have another unit.
inline constexpr const char* kCheckTimes =
    "check the unit of the times, for milliseconds with --columns time_ms=NAME";

/// Throws InputError if a step of `step_s` is so long that each sample would lose the state. `step`
/// names the step of `source` in the message; `mend` is a remedy in addition to a longer gap.
void refuse_long_step(const MotionEstimatorParameters& parameters, double step_s,
                      const std::string& source, const char* step, const char* mend);

}  // namespace condyle::host
