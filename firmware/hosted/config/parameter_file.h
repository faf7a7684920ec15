// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "condyle/estimator/published/parameters.h"
#include "condyle/estimator/sensors/recommended_parameters.h"

namespace condyle::host {

/// Parameters as a file gave them.
struct LoadedParameters {
  PublishedParameters values;      ///< defaults where the file is silent
  bool gives_sample_time = false;  ///< else the recording's median step is to be used
};

/// Loads a TOML parameter file of the published cascade. Everything in it must be known and in
/// range; else an InputError names line, column and mend.
LoadedParameters load_parameters(const std::string& path);

/// The same for the recommended estimator.
RecommendedParameters load_recommended_parameters(const std::string& path);
/// The same from `text`, which messages call `name`.
RecommendedParameters parse_recommended_parameters(const std::string& name, std::string_view text);

/// The text of a parameter file that says `parameters`, without sample_time_s unless it
/// `gives_sample_time`.
std::string parameters_toml(const LoadedParameters& parameters);
/// The same for the recommended estimator: what differs from the defaults, and all of the noise.
std::string parameters_toml(const RecommendedParameters& parameters);

}  // namespace condyle::host
