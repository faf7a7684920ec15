// SPDX-License-Identifier: Apache-2.0
// The condyle command; exit codes are in commands.h.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <utility>
#include <vector>

#include "clean_text.h"
#include "commands.h"
#include "deferred_problem.h"
#include "input_error.h"
#include "last_words.h"

namespace condyle::host {
namespace {

std::atomic<bool> stop_signal{false};  // also read by threads
static_assert(std::atomic<bool>::is_always_lock_free);

// Without SA_RESTART, so that waiting for a pipe ends as well.
void stop_on(int signal) {
  struct sigaction action = {};
  action.sa_handler = [](int) { stop_signal = true; };
  sigaction(signal, &action, nullptr);
}

int run(int argc, char** argv) {
  stop_on(SIGINT);
  stop_on(SIGTERM);
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a write error, reported as one
  std::signal(SIGXFSZ, SIG_IGN);  // and so is a file that may not grow

  Program program("Virtual sensor for jaw motion. Research use only; it diagnoses nothing.");
  program.set_version("condyle " CONDYLE_VERSION);
  const CommandLine line = program.line();
  line.require_command();
  std::vector<std::pair<const char*, Command>> commands;
  commands.emplace_back("replay", add_replay(line));
  commands.emplace_back("simulate", add_simulate(line));
  commands.emplace_back("evaluate", add_evaluate(line));
  commands.emplace_back("friction", add_friction(line));
  commands.emplace_back("observability", add_observability(line));
  commands.emplace_back("protocol", add_protocol(line));
  commands.emplace_back("changes", add_changes(line));
  commands.emplace_back("tune", add_tune(line));
  commands.emplace_back("compare", add_compare(line));
  commands.emplace_back("record", add_record(line));
  commands.emplace_back("bridge", add_bridge(line));
  commands.emplace_back("session", add_session(line));
  commands.emplace_back("inspect", add_inspect(line));
  commands.emplace_back("doctor", add_doctor(line));
  commands.emplace_back("fake", add_fake(line));
  const Program::Parsed parsed = program.parse(argc, argv);
  if (parsed != Program::Parsed::run) {
    return parsed == Program::Parsed::answered ? kExitOk : kExitBadInput;
  }
  try {
    for (const auto& [name, command] : commands) {
      if (!line.is_given(name)) continue;
      const int exit_code = command();
      for (const std::string& problem : deferred_problems()) print_error(problem);
      return exit_code == kExitOk && !deferred_problems().empty() ? kExitBadInput : exit_code;
    }
  } catch (const InputError& error) {
    if (stop_requested()) {  // what looks like an error is the interrupted wait
      return report_stop();
    }
    print_error(error.what());
  }
  return kExitBadInput;
}

}  // namespace

bool stop_requested() {
  return stop_signal;
}

void print_output(const std::string& raw) {
  const std::string text = clean_lines(raw);
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw InputError("standard output", "cannot be written", "give it a place that takes the text");
  }
}

void print_error(const std::string& text) {
  const std::string line = "condyle: " + clean_lines(text) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

int report_stop() {
  print_error("stopped; no file was left");
  return kExitInterrupted;
}

}  // namespace condyle::host

int main(int argc, char** argv) {
  condyle::host::end_with_last_words("condyle", condyle::host::kExitInternal);
  try {
    return condyle::host::run(argc, argv);
  } catch (const std::exception& error) {
    return condyle::host::say_last_words("condyle", error, condyle::host::kExitInternal);
  }
}
