// SPDX-License-Identifier: Apache-2.0
// How well a tuning of the published cascade satisfies the paper's criterion: stage 3 returns the
// assumed mass and friction stays steady.
//
// For a recording r, over the last quarter of its run (as in matching_verdict.h, from the first
// measured position on), with stage 3's mass m, stage 2's friction kv and its mean k:
//
//   J_r = min(rms(m / m0 - 1), 10) + min(rms(kv - k) / |k|, 10) + (10 if it diverged)
//   J   = sum of J_r
//
// Values that are not finite count as 10. No term favours a particular friction. A tuning satisfies
// the criterion if every recording's verdict is `matched`, the range of kv is at most
// `steady_share` of k, and kv is positive, as friction must be.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "condyle/estimator/published/matching_verdict.h"
#include "condyle/estimator/published/parameters.h"

namespace condyle::host {

/// A recording for tuning.
struct PublishedRecording {
  std::string name;                ///< for messages
  double sample_time_s = 0;        ///< replaces the parameters'
  std::vector<double> position_m;  ///< NaN or infinity: no measurement in that sample
  bool is_cut = false;             ///< the recording is longer, but only this part is stored
};

/// The result of a tuning on one recording, over the last quarter. NaN if the filters were not
/// finite.
struct TunedRecording {
  double friction_Ns_m = 0;   ///< mean
  double friction_range = 0;  ///< highest less lowest, as a share of the mean
  double mass_kg = 0;         ///< mean
  double mass_deviation = 0;  ///< rms of m / m0 - 1
  double objective = 0;       ///< J_r
  Verdict verdict = Verdict::not_matched;
  bool satisfies = false;  ///< the criterion, for this recording
};

/// A tuning and its result on each recording.
struct PublishedTuning {
  PublishedParameters parameters;  ///< sample_time_s is the base's
  std::vector<TunedRecording> recordings;
  double objective = 0;      ///< J
  bool satisfies = false;    ///< the criterion, for every recording
  double friction_Ns_m = 0;  ///< mean of the recordings'
  double mass_kg = 0;        ///< mean of the recordings'
};

/// Index of the sample with which the last quarter begins.
std::size_t first_judged_sample(const PublishedRecording& recording);

/// Runs the cascade with `parameters`, which must satisfy `is_valid`, over `recordings` and judges
/// it. Each recording must have a measured position.
PublishedTuning judge_published_tuning(std::span<const PublishedRecording> recordings,
                                       const PublishedParameters& parameters, double steady_share);

}  // namespace condyle::host
