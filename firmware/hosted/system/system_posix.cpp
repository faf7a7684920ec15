// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "hosted/system/system.h"

namespace condyle::host {
namespace {

// Without SA_RESTART, so that a signal also ends a wait for a pipe.
void call_on(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  sigaction(signal, &action, nullptr);
}

}  // namespace

void prepare_program(void (*stop)(int)) {
  call_on(SIGINT, stop);
  call_on(SIGTERM, stop);
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);
}

// Only a signal ends the write; the program's handler of SIGTERM has no other effect by then.
void interrupt_write(std::thread& thread) {
  pthread_kill(thread.native_handle(), SIGTERM);
}

std::FILE* duplicate_standard_output() {
  const int descriptor = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
  return descriptor >= 0 ? fdopen(descriptor, "wb") : nullptr;
}

bool is_on_disk(std::FILE* file) {
  struct stat status = {};
  return fstat(fileno(file), &status) == 0 && S_ISREG(status.st_mode);
}

std::FILE* make_file_beside(std::string& path) {
  struct stat status = {};
  const bool exists = stat(path.c_str(), &status) == 0;
  path += ".partial-XXXXXX";
  const int descriptor = mkstemp(path.data());
  if (descriptor < 0) return nullptr;
  const mode_t mask = umask(0);
  umask(mask);
  if (fchmod(descriptor, exists ? status.st_mode & 0777 : 0666 & ~mask) != 0) return nullptr;
  return fdopen(descriptor, "wb");
}

void discard_unread(std::FILE* file) {
  fcntl(fileno(file), F_SETFL, O_NONBLOCK);
}

std::optional<long> JobProcesses::start(const std::function<int()>& job) {
  std::fflush(nullptr);
  const pid_t parent = getpid();
  const pid_t process = fork();
  if (process < 0) return std::nullopt;
  if (process == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(EXIT_FAILURE);
    // A key on the terminal reaches all; the parent ends its jobs.
    signal(SIGINT, SIG_IGN);
    const int exit_code = job();
    std::fflush(nullptr);
    _exit(exit_code);
  }
  jobs_.emplace(process, std::nullopt);
  return process;
}

std::optional<JobProcesses::Ended> JobProcesses::take_ended() {
  int status = 0;
  const pid_t process = waitpid(-1, &status, WNOHANG);
  if (jobs_.erase(process) == 0) return std::nullopt;
  Ended ended{.id = process};
  if (WIFEXITED(status)) {
    ended.exit_code = WEXITSTATUS(status);
  } else {
    ended.signal = WTERMSIG(status);
  }
  return ended;
}

void JobProcesses::end_all() {
  for (const auto& [process, exit_code] : jobs_) kill(static_cast<pid_t>(process), SIGKILL);
  for (const auto& [process, exit_code] : jobs_) waitpid(static_cast<pid_t>(process), nullptr, 0);
  jobs_.clear();
}

}  // namespace condyle::host
