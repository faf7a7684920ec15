// SPDX-License-Identifier: Apache-2.0
// A fitted release as text, JSON and figure.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "condyle/estimator/release/release_pair.h"
#include "output/output_file.h"
#include "protocols/release/release_recording.h"

namespace condyle::host {

/// A fitted release and its samples.
struct FittedRelease {
  std::string recording;
  ReleaseStretch stretch;
  PassiveRelease<double> fit;
  bool is_noise_stated = false;
};

/// Fits the release that `source` names. Throws InputError with a remedy if it cannot be fitted.
FittedRelease fit_release(const ReleaseSource& source, const ReleaseSettings& settings);

/// Its values with intervals and provenance, and the judgement of the residuals.
std::string release_text(const FittedRelease& release);
/// The same as JSON, without the samples; null: not known.
std::string release_json(const FittedRelease& release);

/// Of a pair; `second` has the load.
std::string pair_text(const FittedRelease& first, const FittedRelease& second,
                      const ReleasePair<double>& pair);
std::string pair_json(const FittedRelease& first, const FittedRelease& second,
                      const ReleasePair<double>& pair);

/// Draws measured and fitted positions over time, and the residuals below, as NAME.svg and
/// NAME.png. The files are closed but not committed.
std::vector<std::unique_ptr<OutputFile>> draw_releases(
    const std::string& directory,
    const std::vector<std::pair<std::string, const FittedRelease*>>& releases);

}  // namespace condyle::host
