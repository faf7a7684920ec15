// SPDX-License-Identifier: Apache-2.0
// A fitted release in words, as JSON and as a picture.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "condyle/estimator/release/release_pair.h"
#include "output/output_file.h"
#include "protocols/release/release_recording.h"

namespace condyle::host {

/// A release and what it was fitted to.
struct FittedRelease {
  std::string recording;
  ReleaseStretch stretch;
  PassiveRelease<double> fit;
};

/// Fits the release that `source` names. Throws InputError if it cannot be fitted, with the way
/// out.
FittedRelease fit_release(const ReleaseSource& source, const ReleaseSettings& settings);

/// Its values with intervals and provenance, and what the residuals say.
std::string release_text(const FittedRelease& release);
/// Likewise as JSON, without the samples; null: not known.
std::string release_json(const FittedRelease& release);

/// Of a pair; `second` has the load.
std::string pair_text(const FittedRelease& first, const FittedRelease& second,
                      const ReleasePair<double>& pair);
std::string pair_json(const FittedRelease& first, const FittedRelease& second,
                      const ReleasePair<double>& pair);

/// Draws measured and fitted positions over time, and the residuals below, as NAME.svg and
/// NAME.png. The files are closed, and wait for `commit`.
std::vector<std::unique_ptr<OutputFile>> draw_releases(
    const std::string& directory,
    const std::vector<std::pair<std::string, const FittedRelease*>>& releases);

}  // namespace condyle::host
