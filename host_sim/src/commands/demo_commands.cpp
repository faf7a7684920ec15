// SPDX-License-Identifier: Apache-2.0
// The subcommands of condyle-demo: those of README's first example, which need two thirds of the
// files.
#include "commands/commands.h"
#include "hosted/files/input_error.h"

namespace condyle::host {

Commands add_commands(CommandLine line) {
  Commands commands;
  commands.emplace_back("analyse", add_analyse(line));
#ifdef CONDYLE_HAS_REPORT
  commands.emplace_back("report", add_report(line));
#endif
  commands.emplace_back("replay", add_replay(line));
  commands.emplace_back("simulate", add_simulate(line));
  return commands;
}

void refuse_absent(const Commands& commands, const std::vector<std::string>& words) {
  if (words.empty() || words[0] == "help" || words[0].starts_with('-')) return;
  for (const auto& [name, command] : commands) {
    if (words[0] == name) return;
  }
  throw InputError(words[0], "condyle-demo has few commands, and not this one",
                   "build condyle: cmake --build --preset release --target condyle");
}

}  // namespace condyle::host
