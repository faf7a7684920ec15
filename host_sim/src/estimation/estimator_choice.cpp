// SPDX-License-Identifier: Apache-2.0
#include "estimation/estimator_choice.h"

#include <fmt/format.h>

#include "hosted/files/input_error.h"

namespace condyle::host {

void EstimatorChoice::refuse_if_published(const char* option, bool given,
                                          const char* chosen_by) const {
  if (!is_published() || !given) return;
  throw InputError(option, fmt::format("is not supported by {} published", chosen_by),
                   fmt::format("leave it out, or give {} recommended", chosen_by));
}

LoadedParameters EstimatorChoice::load_published() const {
  if (!parameters.empty()) return load_parameters(parameters);
  if (!parameters_toml.empty()) return parse_parameters("parameters", parameters_toml);
  return {};
}

RecommendedParameters EstimatorChoice::load_recommended() const {
  if (!parameters.empty()) return load_recommended_parameters(parameters);
  if (!parameters_toml.empty()) return parse_recommended_parameters("parameters", parameters_toml);
  return {};
}

RecommendedParameters load_recommended_for(const EstimatorChoice& estimator,
                                           const RecordingInfo& info, const std::string& source) {
  if (!estimator.parameters.empty() || !estimator.parameters_toml.empty() ||
      info.parameters_toml.empty()) {
    return estimator.load_recommended();
  }
  return parse_recommended_parameters(source + ": its parameters", info.parameters_toml);
}

PublishedParameters load_published_for(const EstimatorChoice& estimator,
                                       std::optional<TimeNs> step_ns, const std::string& source) {
  LoadedParameters loaded = estimator.load_published();
  if (loaded.gives_sample_time) return loaded.values;
  if (!step_ns) {
    throw InputError(source, "no time passes between its samples",
                     "give sample_time_s in a parameter file");
  }
  loaded.values.sample_time_s = seconds(*step_ns);
  if (!is_valid(loaded.values)) {
    throw InputError(source,
                     fmt::format("its median step of {:.4g} s is not a usable sample time",
                                 loaded.values.sample_time_s),
                     fmt::format("{}, or give sample_time_s in a parameter file", kCheckTimes));
  }
  return loaded.values;
}

void refuse_long_step(const MotionEstimatorParameters& parameters, double step_s,
                      const std::string& source, const char* step, const char* mend) {
  const double longest_gap_s = parameters.outliers.longest_gap_s;
  if (step_s <= longest_gap_s) return;
  throw InputError(source,
                   fmt::format("{} of {:.4g} s is longer than longest_gap_s = {:.4g}, so no two "
                               "samples could be related",
                               step, step_s, longest_gap_s),
                   fmt::format("{}, or raise longest_gap_s in a parameter file", mend));
}

}  // namespace condyle::host
