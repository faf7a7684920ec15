// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands/commands.h"
#include "commands/inspect_devices.h"
#include "condyle/hal/hid/report_descriptor.h"
#include "hosted/devices/device_text.h"
#include "hosted/files/input_error.h"
#include "inspect/descriptor_file.h"
#include "inspect/descriptor_text.h"
#include "options/analysis_options.h"
#include "options/command_line.h"

namespace condyle::host {
namespace {

int inspect_descriptor(const InspectOptions& options) {
  const auto result = hal::parse_report_descriptor(read_descriptor_file(options.descriptor));
  if (!result.descriptor) {
    print_error(fmt::format("{}: byte {}: {}; this report descriptor cannot be decoded",
                            options.descriptor, result.error.byte_offset, result.error.reason));
    return kExitRefused;
  }
  if (result.descriptor->reports.empty()) {
    print_error(
        fmt::format("{}: it describes no reports; give the report descriptor of an input "
                    "device, as bytes or as hexadecimal text",
                    options.descriptor));
    return kExitRefused;
  }
  print_output(options.as_json ? descriptor_json(*result.descriptor)
                               : descriptor_text(*result.descriptor));
  return kExitOk;
}

int inspect(const InspectOptions& options) {
  const bool is_live = !options.device.empty() || !options.profile.empty();
  if (!options.descriptor.empty() && is_live) {
    throw InputError("--descriptor",
                     "names a file, but --device and --profile name a device that is plugged in",
                     "give only one of them");
  }
  if (!options.descriptor.empty()) return inspect_descriptor(options);
  return is_live ? inspect_device(options) : list_devices(options);
}

}  // namespace

Command add_inspect(CommandLine app) {
  auto options = std::make_shared<InspectOptions>();
  const CommandLine command = app.add_command("inspect",
                                              "List the HID devices that are plugged in, show what "
                                              "one of them sends, or decode a report descriptor",
                                              "Measure with a device");
  command.add_example("condyle inspect", "List the HID devices of this computer.");
  command.add_example("condyle inspect --device 1209:0001 --duration-s 10",
                      "Show what a device sends.");
  command.add_option(
      "--device", options->device,
      "Device to read: its ids as in 1209:0001, /dev/hidraw0, or its USB port, 1-1.4");
  command.add_option(
      "--profile=FILE", options->profile,
      fmt::format("{}; read that device, and show the decoded values", kProfileMeaning));
  command.add_option(
      "--descriptor=FILE", options->descriptor,
      "File with a report descriptor, binary or hexadecimal text, instead of a device");
  command.add_option("--serial", options->serial, "Serial number, if several are plugged in");
  command.add_option("--backend", options->backend, "hidapi: the kernel's driver; libusb: directly")
      .one_of({"hidapi", "libusb"})
      .show_default();
  command.add_option("--duration-s", options->duration_s, "How long to read; Ctrl-C ends it sooner")
      .number_in({0.1, 1e7})
      .show_default();
  command.add_flag("--json", options->as_json, "Print JSON, for programs");
  return [options] { return inspect(*options); };
}

}  // namespace condyle::host
