// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "commands.h"
#include "condyle/hal/report_descriptor.h"
#include "descriptor_file.h"
#include "descriptor_text.h"

namespace condyle::host {
namespace {

struct InspectOptions {
  std::string descriptor;
  bool as_json = false;
};

int inspect_descriptor(const InspectOptions& options) {
  const auto result = hal::parse_report_descriptor(read_descriptor_file(options.descriptor));
  if (!result.descriptor) {
    print_error(fmt::format("{}: byte {}: {}; it is no report descriptor that can be decoded",
                            options.descriptor, result.error.byte_offset, result.error.reason));
    return kExitRefused;
  }
  print_output(options.as_json ? descriptor_json(*result.descriptor)
                               : descriptor_words(*result.descriptor));
  return kExitOk;
}

}  // namespace

Command add_inspect(CLI::App& app) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* const command =
      app.add_subcommand("inspect", "Say what a HID report descriptor describes");
  command
      ->add_option("--descriptor", options->descriptor,
                   "File with a report descriptor, binary or hexadecimal text")
      ->required();
  command->add_flag("--json", options->as_json, "As JSON, for programs");
  return [options] { return inspect_descriptor(*options); };
}

}  // namespace condyle::host
