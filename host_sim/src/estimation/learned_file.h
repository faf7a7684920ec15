// SPDX-License-Identifier: Apache-2.0
// Files of what a recording has taught, to begin another one of the same subject.
#pragma once

#include <string>

#include "hosted/estimates/learned_motion.h"

namespace condyle::host {

/// Options for learning.
struct LearnedFiles {
  std::string begin_with;  ///< what an earlier recording taught; empty: nothing
  std::string out;         ///< for what this one teaches; empty: none

  bool are_given() const { return !begin_with.empty() || !out.empty(); }
  /// Throws InputError if they are given, but nothing is learned.
  void refuse_unless(bool learns) const;
};

/// Reads a file of learned_text, or a session log that holds one. Throws InputError if it cannot be
/// used along `axis_count` axes, for samples `step_s` apart (0: not known), with `most_kernels` and
/// `lag`.
LearnedMotion read_learned(const std::string& path, int axis_count, double step_s,
                           double most_kernels, int lag);
/// The same from the text of such a file, as part of the file `path`.
LearnedMotion parse_learned(const std::string& text, const std::string& path, int axis_count,
                            double step_s, double most_kernels, int lag);

}  // namespace condyle::host
