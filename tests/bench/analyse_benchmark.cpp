// SPDX-License-Identifier: Apache-2.0
// Time and memory of `condyle analyse` for an hour at 200 Hz: chewing without a pause, and
// sequences with pauses, swallows and speech. usage: analyse_benchmark [HOURS]     (needs 200 MB an
// hour in the folder for temporary files)
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "simulation/kinematic/jaw_text.h"
#include "simulation/kinematic/kinematic_simulation.h"
#include "support/command.h"
#include "support/temporary_folder.h"

namespace {

using namespace condyle::host;
using condyle::testing_support::run_condyle;
using condyle::testing_support::TemporaryFolder;

// A session with all tasks, of which chewing takes nearly `hours`.
JawScenario session(double hours, bool has_pauses) {
  JawScenario scenario;
  scenario.name = "session";
  scenario.facebow.rate_Hz = 200;
  scenario.landmarks = {.condyle_sd_mm = 1, .incisor_sd_mm = 0.5, .plane_sd_mm = 1};
  for (const JawTaskKind kind : {JawTaskKind::rest, JawTaskKind::opening, JawTaskKind::protrusion,
                                 JawTaskKind::left, JawTaskKind::right, JawTaskKind::chewing}) {
    scenario.tasks.push_back(default_task(kind));
  }
  JawTask& chewing = scenario.tasks.back();
  chewing.duration_s = hours * 3600 - 60;
  if (!has_pauses) {
    chewing.chewing.cycles_in_sequence = 1000;
    chewing.chewing.swallows = false;
    chewing.chewing.speech_s = 0;
  }
  return scenario;
}

// Of all ended commands.
double processor_s() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void write(const std::string& path, const std::string& text) {
  std::ofstream(path) << text;
}

}  // namespace

int main(int argc, char** argv) {
  const double hours = argc > 1 ? std::atof(argv[1]) : 1;
  const TemporaryFolder folder;
  std::printf("%-34s%10s%10s%10s%14s%12s\n", "", "samples", "cycles", "seconds", "processor s",
              "peak MiB");
  for (const bool has_pauses : {true, false}) {
    const std::string recording = folder / "recording.csv", landmarks = folder / "landmarks.toml";
    std::size_t samples = 0, cycles = 0;
    {
      const JawScenario scenario = session(hours, has_pauses);
      const KinematicSimulation simulation(scenario, 1);
      samples = simulation.samples().size();
      cycles = simulation.jaw().motion().cycles().size();
      write(recording, jaw_recording_csv(simulation.samples()));
      write(landmarks, jaw_landmarks_toml(simulation, scenario.landmarks));
      write(folder / "tasks.csv", jaw_tasks_csv(simulation.tasks()));
    }
    const auto report = [&](const char* what, const std::vector<std::string>& more) {
      std::vector<std::string> arguments = {"analyse", recording, "--landmarks",
                                            landmarks, "--tasks", folder / "tasks.csv"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      const double before_s = processor_s();
      const auto start = std::chrono::steady_clock::now();
      const auto result = run_condyle(arguments);
      const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
      if (result.exit_code != 0) {
        std::fprintf(stderr, "%s", result.errors.c_str());
        std::exit(1);
      }
      std::printf("%-34s%10zu%10zu%10.1f%14.1f%12.1f\n", what, samples, cycles, wall.count(),
                  processor_s() - before_s, static_cast<double>(result.peak_memory_kB) / 1024);
      std::fflush(stdout);
    };
    report(has_pauses ? "with pauses, summary only" : "without pauses, summary only", {});
    report("  all files, no figures", {"--out", folder / "readings", "--no-figures"});
    report("  all files and figures", {"--out", folder / "readings"});
  }
  return 0;
}
