// SPDX-License-Identifier: Apache-2.0
#include "recordings/simulated_recording.h"

#include <fmt/format.h>

#include <cstddef>

#include "simulation/kinematic/jaw_scenario_file.h"
#include "simulation/kinematic/kinematic_simulation.h"
#include "simulation/scenario_file.h"

namespace condyle::host {
namespace {

std::string simulation_note(std::uint64_t seed) {
  return fmt::format("simulated with seed {}: no person was recorded", seed);
}

class SimulatedRecording final : public Recording {
 public:
  SimulatedRecording(std::string path, const Scenario& scenario)
      : path_(std::move(path)), scenario_(scenario), simulation_(scenario_, scenario_.seed) {
    info_.format = "simulation";
    info_.kind = scenario_.facebow.gives_points ? SampleKind::three_points : SampleKind::one_axis;
    info_.notes.push_back(simulation_note(scenario_.seed));
  }

  bool next(Sample& sample) override {
    while (used_ == data_.samples.size()) {
      data_.clear();
      used_ = 0;
      if (!simulation_.advance(data_)) return false;
    }
    sample = data_.samples[used_++];
    return true;
  }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override {
    return fmt::format("{}: at {:.6g} s", path_, simulation_.time_s());
  }
  double progress() const override { return simulation_.time_s() / scenario_.duration_s; }

 private:
  std::string path_;
  Scenario scenario_;
  Simulation simulation_;
  SimulatedData data_;
  std::size_t used_ = 0;
  RecordingInfo info_;
};

class KinematicRecording final : public Recording {
 public:
  KinematicRecording(std::string path, const JawScenario& scenario)
      : path_(std::move(path)), simulation_(scenario, scenario.seed) {
    info_.format = "simulation";
    info_.kind = SampleKind::three_points;
    info_.notes.push_back(simulation_note(scenario.seed));
  }

  bool next(Sample& sample) override {
    if (used_ == simulation_.samples().size()) return false;
    sample = simulation_.samples()[used_++];
    return true;
  }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override {
    const double instant_s = used_ == 0 ? 0 : simulation_.instants_s()[used_ - 1];
    return fmt::format("{}: at {:.6g} s", path_, instant_s);
  }
  double progress() const override {
    return static_cast<double>(used_) / static_cast<double>(simulation_.samples().size());
  }

 private:
  std::string path_;
  KinematicSimulation simulation_;
  std::size_t used_ = 0;
  RecordingInfo info_;
};

}  // namespace

std::unique_ptr<Recording> open_simulation(const std::string& path) {
  if (is_jaw_scenario(path)) {
    return std::make_unique<KinematicRecording>(path, load_jaw_scenario(path));
  }
  return std::make_unique<SimulatedRecording>(path, load_scenario(path));
}

std::unique_ptr<Recording> open_simulation(const Scenario& scenario) {
  return std::make_unique<SimulatedRecording>(scenario.name, scenario);
}

}  // namespace condyle::host
