// SPDX-License-Identifier: Apache-2.0
#include "fake/fake_setup.h"

#include <fmt/format.h>

#include "recordings/recording.h"
#include "recordings/simulated_recording.h"

namespace condyle::host::fake {
namespace {

constexpr double kNominalRate_Hz = 500;

Motion::Opener opener_of(const FakeOptions& options) {
  if (!options.motion.empty()) {
    RecordingOptions reading = options.reading;
    reading.faults = FaultPolicy::event;
    return [source = options.motion, reading] { return open_recording(source, reading); };
  }
  Scenario scenario;
  scenario.name = "a simulated subject";
  scenario.subject.jaw = tabulated_hinge_jaw("artisynth");
  scenario.facebow.rate_Hz = options.rate_Hz.value_or(kNominalRate_Hz);
  return [scenario] { return open_simulation(scenario); };
}

std::string describe(const FakeOptions& options, const RunOptions& run,
                     std::optional<double> motion_rate_Hz) {
  std::string text =
      fmt::format("fake facebow: {} at {:.6g} reports per second",
                  options.motion.empty() ? "a simulated subject" : options.motion, run.rate_Hz);
  const double speed = run.rate_Hz / motion_rate_Hz.value_or(run.rate_Hz);
  if (speed < 0.99 || speed > 1.01) {
    text += fmt::format("; it moves {:.3g} times as fast as recorded", speed);
  }
  return text;
}

}  // namespace

FakeSetup set_up(const FakeOptions& options) {
  std::uint64_t seed = 1;
  std::vector<FaultRule> rules;
  if (!options.fault_file.empty()) rules = load_faults(options.fault_file, seed);
  for (const std::string& text : options.faults) rules.push_back(parse_fault(text));
  seed = options.seed.value_or(seed);

  Motion motion(opener_of(options), !options.stops_at_end);
  const auto motion_rate_Hz = motion.rate_Hz();
  RunOptions run = options.run;
  run.seed = seed;
  run.rate_Hz = options.rate_Hz.value_or(motion_rate_Hz.value_or(kNominalRate_Hz));
  return {FacebowDevice(options.device, std::move(motion)), FaultScript(std::move(rules), seed),
          run, describe(options, run, motion_rate_Hz)};
}

}  // namespace condyle::host::fake
