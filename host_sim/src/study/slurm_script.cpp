// SPDX-License-Identifier: Apache-2.0
#include "study/slurm_script.h"

#include <fmt/format.h>

namespace condyle::host {

std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) {
    if (c == '\'') {
      word += "'\\''";
    } else {
      word += c;
    }
  }
  return word + "'";
}

std::string slurm_script(const std::string& dataset, const std::string& out,
                         const std::string& words, std::uint64_t shards) {
  return fmt::format(
      "#!/bin/bash\n"
      "# Submit with: sbatch THIS_FILE. A job that is ended or requeued goes on where it stopped.\n"
      "#SBATCH --job-name=condyle-study\n"
      "#SBATCH --array=1-{0}\n"
      "#SBATCH --cpus-per-task=1\n"
      "#SBATCH --requeue\n"
      "set -euo pipefail\n"
      "condyle study {1} {2} participant {3}--jobs \"${{SLURM_CPUS_PER_TASK:-1}}\" "
      "--shard \"$SLURM_ARRAY_TASK_ID/{0}\"\n"
      "# After the last job of the array:\n"
      "#   sbatch --dependency=afterok:JOB_ID --wrap=\"condyle study {1} {2} group\"\n",
      shards, shell_word(dataset), shell_word(out), words);
}

}  // namespace condyle::host
