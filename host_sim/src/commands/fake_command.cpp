// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands/commands.h"
#include "fake/delivery_log.h"
#include "fake/fake_arguments.h"
#include "fake/fake_run.h"
#include "fake/uhid_transport.h"
#include "fake/vhci_transport.h"
#include "hosted/files/input_error.h"
#include "options/command_line.h"
#include "output/progress.h"

namespace condyle::host {
namespace {

struct Options {
  fake::FakeOptions device;
  std::string transport = "uhid";
  std::uint16_t product_id = fake::kProductId;
};

std::unique_ptr<fake::Transport> make_transport(const Options& options) {
  if (options.transport == "uhid") {
    return std::make_unique<fake::UhidTransport>(options.product_id);
  }
  if (options.product_id == fake::kProductId) return std::make_unique<fake::VhciTransport>();
  throw InputError("--product-id", "works with uhid only", "leave it out, or use --transport uhid");
}

int run_fake(const Options& options) {
  const auto transport = make_transport(options);
  if (options.device.run.pacing == fake::Pacing::by_consumption && !transport->knows_taken()) {
    throw InputError("--by-consumption",
                     options.transport + " does not report which reports were read",
                     "use --transport vhci, or leave it out");
  }
  fake::FakeSetup setup = fake::set_up(options.device);
  hal::SteadyClock clock;
  fake::FakeRun run(setup.device, setup.script, *transport, clock, setup.run);
  print_error(setup.description + "; press Ctrl-C to end it");
  {
    Progress progress("playing", clock, 1);
    run.run([&] {
      progress.show(setup.run.count > 0
                        ? static_cast<double>(run.made()) / static_cast<double>(setup.run.count)
                        : setup.device.motion().progress());
      return stop_requested();
    });
  }
  print_output(fake::delivery_log_json(run.delivery_log()) + "\n");
  return stop_requested() ? kExitInterrupted : kExitOk;
}

}  // namespace

Command add_fake(CommandLine app) {
  auto options = std::make_shared<Options>();
  const CommandLine command =
      app.add_command("fake", "Emulate a USB facebow on this computer, with faults (needs root)",
                      "Measure with a device");
  command.add_example("condyle fake --rate-Hz 200",
                      "Plug in a facebow that moves like a simulated subject (as root).");
  command.add_example("condyle fake --transport vhci --fault unplug@1000=0.2",
                      "Unplug it for 0.2 s after 1,000 reports.");
  command
      .add_option("--transport", options->transport, "uhid: a HID device; vhci: a whole USB device")
      .one_of({"uhid", "vhci"})
      .show_default();
  command
      .add_option("--product-id", options->product_id,
                  "Product id of a uhid device, to distinguish several")
      .show_default();
  options->device.run.settle_s = 0.2;  // kernels drop reports that come too early
  fake::add_arguments(command, options->device);
  return [options] { return run_fake(*options); };
}

}  // namespace condyle::host
