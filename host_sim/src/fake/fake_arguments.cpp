// SPDX-License-Identifier: Apache-2.0
#include "fake/fake_arguments.h"

#include <CLI/CLI.hpp>

#include "number_option.h"

namespace condyle::host::fake {

void add_arguments(CLI::App& command, FakeOptions& options) {
  command.add_option("--motion", options.motion,
                     "Recording whose rows the reports hold, or synth:SCENARIO.toml; a simulated "
                     "subject unless given");
  command.add_flag("--no-repeat", options.stops_at_end, "Stop where the motion ends");
  command.add_option("--rate-Hz", options.rate_Hz, "Reports a second; the motion's unless given")
      ->check(number_in({0.1, 8000}));
  command.add_option("--count", options.run.count, "Stop after so many reports");
  command.add_option("--faults", options.fault_file, "TOML file with faults");
  command
      .add_option("--fault", options.faults,
                  "A fault: KIND@REPORT, KIND@TIMEs, KIND/EVERY or KIND~PROBABILITY, then =AMOUNT; "
                  "may be repeated")
      ->allow_extra_args(false);
  command.add_option("--seed", options.seed, "Seed of faults by chance, not the file's");
  command.add_option("--first-counter", options.device.first_counter,
                     "Counter of the first report");
  command.add_option("--first-time-us", options.device.first_time_us,
                     "What the device's clock shows when it is switched on");
  command
      .add_option("--clock-drift-ppm", options.device.clock_drift_ppm,
                  "How much the device's clock runs fast")
      ->check(number_in({-1e5, 1e5}));
  command.add_flag("--restarts", options.device.restarts_on_reconnect,
                   "Counter and clock start anew when it is plugged in again");
  command.add_flag_callback(
      "--by-consumption", [&options] { options.run.pacing = Pacing::by_consumption; },
      "Send each report once the last was taken, not at its time");
  command
      .add_option("--settle-s", options.run.settle_s,
                  "Send nothing for so long after somebody began to read")
      ->check(number_in({0, 3600}))
      ->capture_default_str();
  command
      .add_option("--linger-s", options.run.linger_s,
                  "Stay plugged in so long after the last report was taken")
      ->check(number_in({0, 3600}))
      ->capture_default_str();
}

}  // namespace condyle::host::fake
