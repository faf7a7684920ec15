// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "study/study_plan.h"

namespace condyle::host {

/// A script for sbatch: an array of `shards` jobs, each a shard of the participant level, and the
/// group level after the last. `words`: the command line of the participant level, without shard.
std::string slurm_script(const std::string& dataset, const std::string& out,
                         const std::string& words, std::uint64_t shards);

/// `text` as one word of a shell.
std::string shell_word(const std::string& text);

}  // namespace condyle::host
