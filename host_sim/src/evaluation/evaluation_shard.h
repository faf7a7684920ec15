// SPDX-License-Identifier: Apache-2.0
// A part of the runs of an evaluation as a file, so that many computers can share the work. Merged
// in the order of their runs, the parts give the evaluation of one computer, bit for bit: the file
// holds the numbers of each run exactly, and merging adds them as evaluate_estimator does.
//
// First line: JSON with the format, the version and the set-up, which must be that of all parts.
// Then a line for each run.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "evaluation/estimator_evaluation.h"

namespace condyle::host {

/// What all parts of an evaluation share.
struct EvaluationSetup {
  std::string scenario;       ///< name
  std::string scenario_text;  ///< of its file
  std::string estimator;      ///< in words
  EstimatorSettings settings;
  EvaluationPlan plan;
};

/// The first line of a file of `shard`.
std::string shard_header(const EvaluationSetup& setup, const EvaluationShard& shard);
/// A line with the numbers of `run`, without those of the errors over time.
std::string run_line(EvaluationRun run);

/// An evaluation put together.
struct MergedEvaluation {
  std::string scenario, estimator;
  EvaluationPlan plan;
  Evaluation evaluation;
};

/// Reads the files of all shards, in any order. Throws InputError if one is missing, occurs twice,
/// is incomplete or belongs to another evaluation or version.
MergedEvaluation merge_shards(const std::vector<std::string>& paths);

}  // namespace condyle::host
