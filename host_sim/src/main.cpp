// SPDX-License-Identifier: Apache-2.0
// The condyle command. Exit codes: 0 done, 2 unusable input or command line, 130 interrupted.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <csignal>
#include <exception>
#include <utility>
#include <vector>

#include "commands.h"
#include "input_error.h"

namespace condyle::host {
namespace {

volatile std::sig_atomic_t stop_signal = 0;

int run(int argc, char** argv) {
  std::signal(SIGINT, [](int) { stop_signal = 1; });
  std::signal(SIGTERM, [](int) { stop_signal = 1; });
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a write error, reported as one

  CLI::App app{"Virtual sensor for jaw motion. Research use only; it diagnoses nothing."};
  app.require_subcommand(1);
  app.set_version_flag("--version", "condyle " CONDYLE_VERSION);
  std::vector<std::pair<const char*, Command>> commands;
  commands.emplace_back("replay", add_replay(app));
  commands.emplace_back("observability", add_observability(app));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitOk : kExitBadInput;
  }
  try {
    for (const auto& [name, command] : commands) {
      if (app.got_subcommand(name)) return command();
    }
  } catch (const InputError& error) {
    fmt::print(stderr, "condyle: {}\n", error.what());
  }
  return kExitBadInput;
}

}  // namespace

bool stop_requested() {
  return stop_signal != 0;
}

}  // namespace condyle::host

int main(int argc, char** argv) {
  try {
    return condyle::host::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "condyle: internal error: {}; please report it\n", error.what());
    return 70;
  }
}
