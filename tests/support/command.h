// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace condyle::testing_support {

/// Results of a run of the condyle command.
struct CommandResult {
  int exit_code = -1;  ///< -1: ended by a signal
  std::string output, errors;
  long peak_memory_kB = 0;
};

/// When a run is interrupted (SIGINT).
enum class Interrupt {
  never,
  once_it_can_be,  ///< it handles the signal
  once_it_waits,   ///< and sleeps
};

/// How to run it.
struct CommandOptions {
  bool as_nobody = false;  ///< without root's rights, if the tests have them
  Interrupt interrupt = Interrupt::never;
  std::string output_to, errors_to;  ///< files for them; empty: they are returned
  std::string search_path;           ///< PATH; empty: the tests' own
  long most_file_bytes = 0;          ///< largest size of a file (RLIMIT_FSIZE); 0: any
};

/// Whether its peak of memory is its own. A sanitizer's grows; another build's command may have
/// one.
bool command_memory_is_its_own();

/// Runs `condyle ARGUMENTS...` and waits for its end.
CommandResult run_condyle(const std::vector<std::string>& arguments,
                          const CommandOptions& options = {});

/// Whether the build has `condyle COMMAND`: report and live need the pages for browsers.
/// Throws if `condyle help COMMAND` fails for another reason.
bool condyle_has(const std::string& command);

}  // namespace condyle::testing_support
