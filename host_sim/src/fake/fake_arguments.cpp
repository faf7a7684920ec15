// SPDX-License-Identifier: Apache-2.0
#include "fake/fake_arguments.h"
#include "options/command_line.h"
#include "options/recording_choice.h"

namespace condyle::host::fake {

void add_arguments(CommandLine command, FakeOptions& options) {
  command.add_option("--motion", options.motion,
                     "Recording whose rows the reports hold, or sim:SCENARIO.toml; a simulated "
                     "subject unless given");
  add_reading_options(command.group("How the motion is read"), options.reading);
  command.add_flag("--no-repeat", options.stops_at_end, "Stop where the motion ends");
  command.add_option("--rate-Hz", options.rate_Hz, "Reports a second; the motion's unless given")
      .number_in({0.1, 8000});
  command.add_option("--count", options.run.count, "Stop after so many reports");
  command.add_option("--faults", options.fault_file, "TOML file with faults");
  command
      .add_option("--fault", options.faults,
                  "A fault: KIND@REPORT, KIND@TIMEs, KIND/EVERY or KIND~PROBABILITY, then =AMOUNT; "
                  "may be repeated")
      .one_value_each();
  command.add_option("--seed", options.seed, "Seed of faults by chance, not the file's");
  command.add_option("--first-counter", options.device.first_counter,
                     "Counter of the first report");
  command.add_option("--first-time-us", options.device.first_time_us,
                     "What the device's clock shows when it is switched on");
  command
      .add_option("--clock-drift-ppm", options.device.clock_drift_ppm,
                  "How much the device's clock runs fast")
      .number_in({-1e5, 1e5});
  command.add_flag("--restarts", options.device.restarts_on_reconnect,
                   "Counter and clock start anew when it is plugged in again");
  command.on_flag(
      "--by-consumption", [&options] { options.run.pacing = Pacing::by_consumption; },
      "Send each report once the last was taken, not at its time");
  command
      .add_option("--settle-s", options.run.settle_s,
                  "Send nothing for so long after somebody began to read")
      .number_in({0, 3600})
      .show_default();
  command
      .add_option("--linger-s", options.run.linger_s,
                  "Stay plugged in so long after the last report was taken")
      .number_in({0, 3600})
      .show_default();
}

}  // namespace condyle::host::fake
