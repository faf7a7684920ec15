// SPDX-License-Identifier: Apache-2.0
// The condyle command, and condyle-demo; exit codes are in commands.h.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "commands/commands.h"
#include "commands/manual.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/last_words.h"
#include "hosted/system/system.h"
#include "output/deferred_problem.h"
#include "output/lasting_effect.h"
#include "output/output_file.h"

namespace condyle::host {
namespace {

std::atomic<bool> stop_signal{false};  // also read by threads
static_assert(std::atomic<bool>::is_always_lock_free);

int run_command(int argc, char** argv) {
  Program program("condyle", CONDYLE_VERSION,
                  "Virtual sensor for jaw motion. Research use only; not a diagnosis.");
  const CommandLine line = program.line();
  line.require_command();
  const Commands commands = add_commands(line);
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (words.size() == 3 && words[0] == "help" && words[1] == "--manual") {  // for packages
    write_manual(program.describe(), "condyle " CONDYLE_VERSION, words[2]);
    return kExitOk;
  }
  refuse_absent(commands, words);
  std::string text;
  switch (program.parse(argc, argv, text)) {
    case Program::Parsed::answered:
      print_output(text);
      return kExitOk;
    case Program::Parsed::wrong:
      print_error(text);
      return kExitBadInput;
    case Program::Parsed::run:
      break;
  }
  for (const auto& [name, command] : commands) {
    if (!line.is_given(name)) continue;
    const int exit_code = command();
    for (const std::string& problem : deferred_problems()) print_error(problem);
    return exit_code == kExitOk && !deferred_problems().empty() ? kExitBadInput : exit_code;
  }
  return kExitBadInput;
}

int run(int argc, char** argv) {
  prepare_program([](int) { stop_signal = true; });
  try {
    return run_command(argc, argv);
  } catch (const InputError& error) {
    if (stop_requested() && !has_lasting_effect) {  // the error is the interrupted wait
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
  const bool is_taken = OutputFile::has_standard_output();
  std::FILE* const to = is_taken ? stderr : stdout;
  if (std::fwrite(text.data(), 1, text.size(), to) != text.size() || std::fflush(to) != 0) {
    throw InputError(is_taken ? "standard error" : "standard output", "cannot be written",
                     "redirect it to a file or pipe that accepts the text");
  }
}

bool try_to_print(const std::string& text) {
  try {
    print_output(text);
    return true;
  } catch (const InputError& error) {
    print_error(error.what());
    return false;
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
