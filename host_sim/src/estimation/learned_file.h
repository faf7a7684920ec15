// SPDX-License-Identifier: Apache-2.0
// Files of what a recording has taught, to begin another one of the same subject.
#pragma once

#include <string>

#include "estimation/estimator_choice.h"
#include "hosted/estimates/learned_motion.h"
#include "recordings/recording.h"

namespace condyle::host {

/// Options for learning.
struct LearnedFiles {
  std::string begin_with;  ///< what an earlier recording taught; empty: nothing
  std::string out;         ///< for what this one teaches; empty: none

  bool are_given() const { return !begin_with.empty() || !out.empty(); }
  /// Throws InputError if they are given, but nothing is learned.
  void refuse_unless(bool learns) const;
};

/// True if a replay begins as its session did live: unless other parameters, or a lag, give other
/// estimates anyway.
bool begins_as_session(const RecordingInfo& info, const EstimatorChoice& estimator,
                       const LearnedFiles& files);

/// Reads a file of learned_text, or a session log that holds one. Throws InputError if it cannot be
/// used along `axis_count` axes, for samples `step_s` apart (0: not known), with `most_kernels` and
/// `lag`.
LearnedMotion read_learned(const std::string& path, int axis_count, double step_s,
                           double most_kernels, int lag);
/// What a replay of `recording` begins with: the file that `files` names, or what its session began
/// with; no axes: nothing. Throws as read_learned.
LearnedMotion first_learned(const LearnedFiles& files, const RecordingInfo& info,
                            const EstimatorChoice& estimator, const std::string& recording,
                            int axis_count, double step_s, double most_kernels);

}  // namespace condyle::host
