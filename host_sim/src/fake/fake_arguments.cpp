// SPDX-License-Identifier: Apache-2.0
#include "fake/fake_arguments.h"
#include "options/analysis_options.h"
#include "options/command_line.h"

namespace condyle::host::fake {

void add_arguments(CommandLine command, FakeOptions& options) {
  command.add_option(
      "--motion", options.motion,
      "Recording to send as reports, or sim:SCENARIO.toml; default: a simulated subject");
  add_reading_options(command.group("How the motion is read"), options.reading, FrameRate::no);
  command.add_flag("--no-repeat", options.stops_at_end, "Stop when the motion ends");
  command
      .add_option("--rate-Hz", options.rate_Hz,
                  "Reports per second; default: the rate of the motion")
      .number_in({0.1, 8000});
  command.add_option("--count", options.run.count, "Stop after this number of reports");
  command.add_option("--faults", options.fault_file, "TOML file with faults");
  command
      .add_option("--fault", options.faults,
                  "A fault: KIND@REPORT, KIND@TIMEs, KIND/EVERY or KIND~PROBABILITY, then =AMOUNT; "
                  "may be given several times")
      .one_value_each();
  command.add_option("--seed", options.seed, "Seed of random faults, instead of the file's");
  command.add_option("--first-counter", options.device.first_counter,
                     "Counter of the first report");
  command.add_option("--first-time-us", options.device.first_time_us,
                     "Reading of the device's clock at power-on");
  command
      .add_option("--clock-drift-ppm", options.device.clock_drift_ppm,
                  "Rate by which the device's clock runs fast")
      .number_in({-1e5, 1e5});
  command.add_flag("--restarts", options.device.restarts_on_reconnect,
                   "Restart counter and clock when the device is plugged in again");
  command.on_flag(
      "--by-consumption", [&options] { options.run.pacing = Pacing::by_consumption; },
      "Send each report when the previous one was read, not at its time");
  command
      .add_option("--settle-s", options.run.settle_s,
                  "Send nothing for this time after a program starts to read")
      .number_in({0, 3600})
      .show_default();
  command
      .add_option("--linger-s", options.run.linger_s,
                  "Stay plugged in for this time after the last report was read")
      .number_in({0, 3600})
      .show_default();
}

}  // namespace condyle::host::fake
