// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <memory>

#include "commands/commands.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/files/input_error.h"
#include "inspect/device_argument.h"
#include "inspect/doctor.h"
#include "options/command_line.h"

namespace condyle::host {
namespace {

struct DoctorOptions {
  std::string device, profile, backend = "hidapi";
  bool rule = false;
};

int examine_and_tell(const DoctorOptions& options) {
  std::optional<hal::DeviceAddress> wanted;
  hal::SteadyClock clock;
  if (!options.device.empty()) wanted = wait_for_device(options.device, "", clock, stop_requested);
  if (!options.profile.empty()) {
    const hal::DeviceProfile profile = load_device_profile(options.profile);
    wanted = {.vendor_id = profile.vendor_id,
              .product_id = profile.product_id,
              .interface_number = profile.interface_number,
              .serial = {},
              .path = {}};
  }
  const DeviceBackEnd back_end =
      options.backend == "libusb" ? DeviceBackEnd::libusb : DeviceBackEnd::hidapi;
  const Machine machine = this_machine();
  if (options.rule) {
    if (!wanted) {
      throw InputError("--rule", "no device is given",
                       "add --device 1209:0001 with the ids of condyle inspect, or --profile FILE");
    }
    print_output(udev_rule(device_for_rule(machine, *wanted), back_end, machine.devices) + "\n");
    return kExitOk;
  }
  const std::vector<Finding> findings = examine(machine, wanted, back_end);
  print_output(findings_text(findings));
  const bool is_fit = std::none_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.severity == Severity::missing;
  });
  return is_fit ? kExitOk : kExitRefused;
}

}  // namespace

Command add_doctor(CommandLine app) {
  auto options = std::make_shared<DoctorOptions>();
  const CommandLine command = app.add_command(
      "doctor",
      "Check whether this computer can read a facebow, and print how to fix what is missing",
      "Measure with a device");
  command.add_example("condyle doctor", "Check this computer.");
  command.add_example("condyle doctor --device 1209:0001",
                      "Check whether you may read a device, and print how to fix it.");
  const Option device =
      command.add_option("--device", options->device,
                         "Device to check: 1209:0001, /dev/hidraw0, or its USB port, 1-1.4");
  command.add_option("--profile=FILE", options->profile, "TOML file of the device to check")
      .excludes(device);
  command
      .add_option("--backend", options->backend,
                  "Driver that reads the device: hidapi, the kernel's; libusb, which takes the "
                  "whole device")
      .one_of({"hidapi", "libusb"})
      .show_default();
  command.add_flag(
      "--rule", options->rule,
      "Print only the udev rule that allows reading the device, for a file in /etc/udev/rules.d");
  return [options] { return examine_and_tell(*options); };
}

}  // namespace condyle::host
