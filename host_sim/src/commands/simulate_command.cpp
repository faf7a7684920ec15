// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "commands/commands.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "options/command_line.h"
#include "output/output_file.h"
#include "output/progress.h"
#include "simulation/kinematic/jaw_scenario_file.h"
#include "simulation/kinematic/jaw_text.h"
#include "simulation/recording_writer.h"
#include "simulation/scenario_file.h"

namespace condyle::host {
namespace {

struct SimulateOptions {
  std::string scenario;
  std::string out;
  std::string truth;
  std::optional<std::uint64_t> seed;
};

// "a/b.csv" with "drive" becomes "a/b.drive.csv".
std::string beside(const std::string& path, const std::string& part,
                   const std::string& ending = ".csv") {
  const std::filesystem::path base(path);
  return (base.parent_path() / (base.stem().string() + "." + part + ending)).string();
}

void report(std::uint64_t samples, const std::string& scenario, std::uint64_t seed,
            const std::string& files) {
  print_output(fmt::format("{} samples of {}, seed {}; simulated, no person was recorded\n{}",
                           samples, clean_line(scenario), seed, files));
}

int simulate_jaw(const SimulateOptions& options) {
  const JawScenario scenario = load_jaw_scenario(options.scenario);
  const std::uint64_t seed = options.seed.value_or(scenario.seed);
  if (options.out == "-") {
    throw InputError("--out -", "landmarks and tasks are written into files beside the recording",
                     "name a file");
  }
  const KinematicSimulation simulation(scenario, seed);
  struct Output {
    std::string path, text;
  };
  std::vector<Output> outputs = {{options.out, jaw_recording_csv(simulation.samples())},
                                 {beside(options.out, "landmarks", ".toml"),
                                  jaw_landmarks_toml(simulation, scenario.landmarks)},
                                 {beside(options.out, "tasks"), jaw_tasks_csv(simulation.tasks())}};
  if (!options.truth.empty()) {
    outputs.push_back({options.truth, jaw_poses_csv(simulation)});
    outputs.push_back(
        {beside(options.out, "readings"), jaw_readings_csv(true_readings(simulation.jaw()))});
    outputs.push_back(
        {beside(options.out, "cycles"), jaw_cycles_csv(true_cycles(simulation.jaw()))});
  }
  std::vector<std::string> paths;
  for (const Output& output : outputs) paths.push_back(output.path);
  refuse_same_files({options.scenario}, paths);
  std::vector<std::unique_ptr<OutputFile>> files;
  for (const Output& output : outputs) {
    files.push_back(std::make_unique<OutputFile>(output.path));
    files.back()->write(output.text);
  }
  for (const auto& file : files) file->close();
  report(simulation.samples().size(), scenario.name, seed, commit_all(files));
  return kExitOk;
}

int simulate(const SimulateOptions& options) {
  if (is_jaw_scenario(options.scenario)) return simulate_jaw(options);
  const Scenario scenario = load_scenario(options.scenario);
  const std::uint64_t seed = options.seed.value_or(scenario.seed);
  hal::SteadyClock clock;
  const std::string drive_path =
      scenario.drive.rate_Hz > 0 ? beside(options.out, "drive") : std::string();
  const std::string emg_path =
      scenario.emg.rate_Hz > 0 ? beside(options.out, "emg") : std::string();
  const std::string head_path =
      scenario.head.rate_Hz > 0 ? beside(options.out, "head") : std::string();
  if (options.out == "-" && !(drive_path + emg_path + head_path).empty()) {
    throw InputError(
        "--out -",
        "the scenario also writes drive, EMG or head motion into files beside the recording",
        "name a file");
  }
  refuse_same_files({options.scenario},
                    {options.out, options.truth, drive_path, emg_path, head_path});

  std::vector<std::unique_ptr<OutputFile>> files;
  const auto open = [&files](const std::string& path) {
    files.push_back(std::make_unique<OutputFile>(path));
    return files.back().get();
  };
  OutputFile* const recording = open(options.out);
  OutputFile* const truth = options.truth.empty() ? nullptr : open(options.truth);
  OutputFile* const drive = drive_path.empty() ? nullptr : open(drive_path);
  OutputFile* const emg = emg_path.empty() ? nullptr : open(emg_path);
  OutputFile* const head = head_path.empty() ? nullptr : open(head_path);
  RecordingWriter writer(scenario);
  recording->write(writer.recording_header());
  if (truth != nullptr) truth->write(writer.truth_header());
  if (drive != nullptr) drive->write(writer.drive_header());
  if (emg != nullptr) emg->write(writer.emg_header());
  if (head != nullptr) head->write(writer.head_header());

  Simulation simulation(scenario, seed);
  SimulatedData data;
  std::uint64_t samples = 0;
  {
    Progress progress("simulating", clock);
    while (simulation.advance(data)) {
      for (const Sample& sample : data.samples) recording->write(writer.recording_row(sample));
      if (truth != nullptr) {
        for (const SubjectTruth& state : data.truths) truth->write(writer.truth_row(state));
      }
      if (drive != nullptr) {
        for (const Reading& reading : data.drive) drive->write(writer.value_row(reading));
      }
      if (emg != nullptr) {
        for (const Reading& reading : data.emg) emg->write(writer.emg_row(reading));
      }
      if (head != nullptr) {
        for (const Reading& reading : data.head) head->write(writer.value_row(reading));
      }
      samples += data.samples.size();
      data.clear();
      progress.show(simulation.time_s() / scenario.duration_s);
      if (stop_requested()) {
        return report_stop();
      }
    }
  }
  for (const auto& file : files) file->close();
  const std::string names = commit_all(files);
  report(samples, scenario.name, seed, names);
  return kExitOk;
}

}  // namespace

Command add_simulate(CommandLine app) {
  auto options = std::make_shared<SimulateOptions>();
  const CommandLine command = app.add_command(
      "simulate", "Simulate a subject and the instruments that measure it", "Simulate");
  command.add_example("condyle simulate chewing.toml --out jaw.csv --truth truth.csv",
                      "Write a recording of a simulated subject, and the truth.");
  command.add_example("condyle simulate chewing.toml --out jaw.csv --seed 7",
                      "Use another random seed.");
  command.add_option("SCENARIO", options->scenario, "TOML file; host_sim/scenarios has examples")
      .required();
  command.group("Output")
      .add_option("-o,--out=FILE", options->out, "CSV file for the recording")
      .required();
  command.group("Output").add_option("--truth=FILE", options->truth,
                                     "CSV file for the true states");
  command.add_option("--seed", options->seed,
                     "Seed of all random numbers, instead of the scenario's");
  return [options] { return simulate(*options); };
}

}  // namespace condyle::host
