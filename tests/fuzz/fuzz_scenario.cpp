// SPDX-License-Identifier: Apache-2.0
// Any bytes as a scenario: what is accepted begins to move, all else is refused with a message.
#include <cmath>

#include "fuzz/lines.h"
#include "fuzz/memory_file.h"
#include "hosted/files/input_error.h"
#include "simulation/kinematic/jaw_scenario_file.h"
#include "simulation/kinematic/kinematic_jaw.h"
#include "simulation/scenario_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace condyle;
  const fuzz::MemoryFile file(data, size);
  try {
    if (host::is_jaw_scenario(file.path())) {
      const host::KinematicJaw jaw(host::load_jaw_scenario(file.path()));
      const host::JawPose pose = jaw.pose_at(jaw.motion().duration_s() / 2);
      if (!pose.rotation.allFinite() || !pose.translation_m.allFinite()) std::abort();
      return 0;
    }
    const host::Scenario scenario = host::load_scenario(file.path());
    if (!(scenario.duration_s > 0) || !(scenario.facebow.rate_Hz > 0)) std::abort();
    host::Simulation simulation(scenario, scenario.seed);
    host::SimulatedData simulated;
    static_cast<void>(simulation.advance(simulated));
    if (!std::isfinite(simulation.time_s())) std::abort();
  } catch (const host::InputError& error) {
    fuzz::require_clean(error.what());
  }
  return 0;
}
