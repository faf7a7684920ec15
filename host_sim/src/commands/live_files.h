// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "hosted/files/input_error.h"
#include "hosted/lsl/estimate_stream.h"
#include "output/live_estimates.h"
#include "output/output_file.h"

namespace condyle::host {

/// What `condyle record` writes beside the session log; each may be absent.
struct LiveFiles {
  std::unique_ptr<LiveEstimates> estimates;
  std::unique_ptr<LivePoses> poses;
  std::unique_ptr<LiveCycles> cycles;
  std::unique_ptr<lsl::EstimateStream> stream;
  std::unique_ptr<OutputFile> learned;  ///< at the end: learned_words
  std::string learned_words, learned_problem;

  /// Completes all files.
  void finish() {
    if (estimates) estimates->finish();
    if (poses) poses->finish();
    if (cycles) cycles->finish();
    if (stream) stream->finish();
    if (!learned) return;
    try {
      learned->write(learned_words);
      learned->close();
      learned->commit();
    } catch (const InputError& error) {
      learned_problem = error.what();
    }
  }
  /// Why files are not complete; empty if all are.
  std::string problems() const {
    std::string all = learned_problem;
    const auto add = [&all](const auto& file) {
      if (!file || file->problem().empty()) return;
      all += (all.empty() ? "" : "; ") + file->problem();
    };
    add(estimates);
    add(poses);
    add(cycles);
    return all;
  }
};

}  // namespace condyle::host
