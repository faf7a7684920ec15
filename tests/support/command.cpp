// SPDX-License-Identifier: Apache-2.0
#include "support/command.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

#include "support/paths.h"
#include "support/sanitizer.h"
#include "support/temporary_folder.h"
#include "support/wait_for.h"

namespace condyle::testing_support {
namespace {

// From /proc: a state, and the set of signals that the process handles. Does not wait for a process
// that has ended.
bool can_be_interrupted(pid_t process, Interrupt wanted) {
  std::ifstream file("/proc/" + std::to_string(process) + "/status");
  bool takes_signal = false;
  char state = 'Z';
  for (std::string word; file >> word;) {
    if (word == "State:") file >> state;
    if (word != "SigCgt:") continue;
    unsigned long long signals = 0;
    file >> std::hex >> signals;
    takes_signal = (signals >> (SIGINT - 1) & 1) != 0;
  }
  return state == 'Z' || (takes_signal && (wanted == Interrupt::once_it_can_be || state == 'S'));
}

// The command gets the signal for a file that is too large in the same way as a shell's child.
void limit_files(long most_bytes) {
  const auto most = static_cast<rlim_t>(most_bytes);
  const rlimit limit{most, most};
  setrlimit(RLIMIT_FSIZE, &limit);
  signal(SIGXFSZ, SIG_DFL);
}

}  // namespace

bool command_memory_is_its_own() {
  return !CONDYLE_UNDER_SANITIZER && std::getenv("CONDYLE_COMMAND") == nullptr;
}

CommandResult run_condyle(const std::vector<std::string>& arguments,
                          const CommandOptions& options) {
  const TemporaryFolder folder;
  const std::string out = options.output_to.empty() ? folder.write("out", "") : options.output_to;
  const std::string err = options.errors_to.empty() ? folder.write("err", "") : options.errors_to;
  std::string program = testing_support::program_path("condyle");
  if (options.as_nobody) {  // this user may not enter the build folder
    program = folder / "condyle";
    std::filesystem::copy_file(testing_support::program_path("condyle"), program);
  }
  std::vector<char*> argv{program.data()};
  std::vector<std::string> copies = arguments;
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);

  const pid_t child = fork();
  if (child == 0) {
    const int out_file = open(out.c_str(), O_WRONLY), err_file = open(err.c_str(), O_WRONLY);
    dup2(out_file, STDOUT_FILENO);
    dup2(err_file, STDERR_FILENO);
    if (!options.search_path.empty()) setenv("PATH", options.search_path.c_str(), 1);
    if (options.as_nobody && geteuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0))
      _exit(97);
    if (options.most_file_bytes > 0) {
      limit_files(options.most_file_bytes);
      setenv("GCOV_PREFIX", folder.path().c_str(),
             1);  // the file limit would also cut coverage counts
    }
    execv(argv[0], argv.data());
    _exit(98);
  }
  if (options.interrupt != Interrupt::never) {
    (void)wait_for([&] { return can_be_interrupted(child, options.interrupt); });
    kill(child, SIGINT);
  }
  int status = 0;
  struct rusage usage = {};
  wait4(child, &status, 0, &usage);
  CommandResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (options.output_to.empty()) result.output = read_file(out);
  if (options.errors_to.empty()) result.errors = read_file(err);
  result.peak_memory_kB = usage.ru_maxrss;
  return result;
}

bool condyle_has(const std::string& command) {
  const CommandResult help = run_condyle({"help", command});
  if (help.exit_code == 0) return true;
  if (help.exit_code == 2 && help.errors.find("built without its pages") != std::string::npos) {
    return false;
  }
  throw std::runtime_error("condyle help " + command + ": exit status " +
                           std::to_string(help.exit_code) + "\n" + help.errors);
}

}  // namespace condyle::testing_support
