// SPDX-License-Identifier: Apache-2.0
// Throughput and memory of `condyle replay` on one-axis recordings of 100,000 and 10,000,000 rows,
// with and without learning, and with the published cascade.
// usage: replay_benchmark     (needs 500 MB in the folder for temporary files)
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace {

using condyle::testing_support::run_condyle;
using condyle::testing_support::TemporaryFolder;

struct Measured {
  double wall_s;
  long peak_memory_kB;
};

Measured measure(const std::vector<std::string>& arguments) {
  const auto start = std::chrono::steady_clock::now();
  const auto result = run_condyle(arguments);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  if (result.exit_code != 0) {
    std::fprintf(stderr, "%s", result.errors.c_str());
    std::exit(1);
  }
  return {wall.count(), result.peak_memory_kB};
}

}  // namespace

int main() {
  const TemporaryFolder folder;
  const std::string without_learning = folder.write("none.toml", "[learning]\nkernels = 0\n");
  std::printf("%-34s%12s%12s%12s\n", "", "rows", "rows/s", "peak MiB");
  for (const double rows : {1e5, 1e7}) {
    const std::string path = folder / "recording.csv";
    const std::string make = condyle::testing_support::program_path("make_chewing_recording") +
                             " " + std::to_string((rows - 0.5) / 60) + " 60 > '" + path + "'";
    if (std::system(make.c_str()) != 0) return 1;
    const auto report = [&](const char* what, std::vector<std::string> more) {
      std::vector<std::string> arguments = {"replay", path};
      arguments.insert(arguments.end(), more.begin(), more.end());
      const Measured measured = measure(arguments);
      std::printf("%-34s%12.0f%12.0f%12.1f\n", what, rows, rows / measured.wall_s,
                  static_cast<double>(measured.peak_memory_kB) / 1024);
      std::fflush(stdout);
    };
    report("summary only", {});
    report("without learning", {"--parameters", without_learning});
    report("published cascade", {"--estimator", "published"});
    report("summary, estimates", {"--out", "/dev/null"});
    report("summary, estimates, figures", {"--out", "/dev/null", "--figures", folder / "figures"});
  }
  return 0;
}
