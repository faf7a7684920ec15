// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "condyle/estimator/published/parameters.h"
#include "condyle/estimator/sensors/recommended_parameters.h"

namespace condyle::host {

/// Parameters read from a file.
struct LoadedParameters {
  PublishedParameters values;      ///< defaults for what the file does not set
  bool gives_sample_time = false;  ///< else the recording's median step is used
};

/// Loads a TOML parameter file of the published cascade. Every key must be known and every value in
/// range; else an InputError names line, column and remedy.
LoadedParameters load_parameters(const std::string& path);
/// The same from `text`, which messages call `name`.
LoadedParameters parse_parameters(const std::string& name, std::string_view text);

/// The same for the recommended estimator.
RecommendedParameters load_recommended_parameters(const std::string& path);
/// The same from `text`, which messages call `name`.
RecommendedParameters parse_recommended_parameters(const std::string& name, std::string_view text);

/// The text of a parameter file with `parameters`, without sample_time_s unless it
/// `gives_sample_time`.
std::string parameters_toml(const LoadedParameters& parameters);
/// The same for the recommended estimator: all settings of the noise, and others that differ from
/// their defaults.
std::string parameters_toml(const RecommendedParameters& parameters);

}  // namespace condyle::host
