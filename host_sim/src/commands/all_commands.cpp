// SPDX-License-Identifier: Apache-2.0
// The subcommands of condyle, in the order of its help.
#include "commands/commands.h"
#include "hosted/files/input_error.h"

namespace condyle::host {

Commands add_commands(CommandLine line) {
  Commands commands;
  commands.emplace_back("analyse", add_analyse(line));
#ifdef CONDYLE_HAS_REPORT
  commands.emplace_back("report", add_report(line));
#endif
  commands.emplace_back("info", add_info(line));
  commands.emplace_back("export", add_export(line));
  commands.emplace_back("landmarks", add_landmarks(line));
  commands.emplace_back("study", add_study(line));
  commands.emplace_back("replay", add_replay(line));
  commands.emplace_back("compare", add_compare(line));
  commands.emplace_back("tune", add_tune(line));
  commands.emplace_back("changes", add_changes(line));
  commands.emplace_back("protocol", add_protocol(line));
  commands.emplace_back("simulate", add_simulate(line));
  commands.emplace_back("evaluate", add_evaluate(line));
  commands.emplace_back("friction", add_friction(line));
  commands.emplace_back("observability", add_observability(line));
  commands.emplace_back("inspect", add_inspect(line));
#ifdef CONDYLE_HAS_DEVICES
  commands.emplace_back("doctor", add_doctor(line));
  commands.emplace_back("record", add_record(line));
#ifdef CONDYLE_HAS_LIVE_PAGE
  commands.emplace_back("live", add_live(line));
#endif
  commands.emplace_back("session", add_session(line));
  commands.emplace_back("bridge", add_bridge(line));
  commands.emplace_back("fake", add_fake(line));
#endif
  return commands;
}

void refuse_absent(const Commands& commands, const std::vector<std::string>& words) {
  const std::size_t place = !words.empty() && words[0] == "help" ? 1 : 0;
  if (words.size() <= place) return;
  const std::string& word = words[place];
  for (const auto& [name, command] : commands) {
    if (word == name) return;
  }
#ifndef CONDYLE_HAS_DEVICES
  for (const char* const name : {"doctor", "record", "live", "session", "bridge", "fake"}) {
    if (word != name) continue;
    throw InputError(name, "this command is for devices, which condyle reads on Linux only",
                     "run condyle alone for a list of the other commands");
  }
#endif
  for (const char* const name : {"report", "live"}) {
    if (word != name) continue;
    throw InputError(name, "this condyle was built without its pages for browsers",
                     "cmake --preset release says what it lacks; mend it, and build again");
  }
}

}  // namespace condyle::host
