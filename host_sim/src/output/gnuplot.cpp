// SPDX-License-Identifier: Apache-2.0
#include "output/gnuplot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "output/deferred_problem.h"

namespace condyle::host {
namespace {

void note_failure(const std::string& problem, const char* mend) {
  defer_problem(InputError("gnuplot", "cannot draw the figures: " + problem,
                           fmt::format("{}; all other output was written", mend)));
}

// Gnuplot exits without an error if it cannot write, so check for the end of the file.
bool is_complete(const std::string& path) {
  constexpr std::size_t kLast = 16;
  std::ifstream file(path, std::ios::binary);
  std::string end(kLast, ' ');
  file.seekg(-static_cast<std::streamoff>(kLast), std::ios::end).read(end.data(), kLast);
  return end.find("</svg>") != std::string::npos || end.find("IEND") != std::string::npos;
}

// The absolute path of a program; empty if there is none. Relative folders of PATH are skipped,
// because the child runs in the folder of the figures.
std::string find_program(const std::string& name) {
  const char* const path = std::getenv("PATH");
  std::string_view rest = path != nullptr ? path : "/usr/bin:/bin";
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const std::string program = std::string(rest.substr(0, end)) + "/" + name;
    if (program.front() == '/' && access(program.c_str(), X_OK) == 0) return program;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return "";
}

// Starts it in `folder` with `input` as its input. The child has its own process group, because the
// command handles an interrupt of the terminal. Returns 0 or an error number.
int start(const std::string& program, const std::string& folder, int input, pid_t& child) {
  std::vector<std::string> variables = {"LC_ALL=C.UTF-8"};
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!std::string_view(*variable).starts_with("LC_ALL=")) variables.emplace_back(*variable);
  }
  std::vector<char*> environment;
  for (std::string& variable : variables) environment.push_back(variable.data());
  environment.push_back(nullptr);
  std::array<std::string, 2> words{"gnuplot", "-d"};  // without the user's own settings
  std::array<char*, 3> arguments{words[0].data(), words[1].data(), nullptr};

  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error = posix_spawn(&child, program.c_str(), &actions, &attributes, arguments.data(),
                                environment.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

}  // namespace

std::string why_no_figures() {
  return "";
}

Gnuplot::Gnuplot(std::string directory) : directory_(std::move(directory)) {
  const std::string program = find_program("gnuplot");
  if (program.empty()) {
    problem_ = "it is not installed";
    return;
  }
  int ends[2] = {-1, -1};
  if (pipe2(ends, O_CLOEXEC) != 0) {
    problem_ = std::strerror(errno);
    return;
  }
  if (const int error = start(program, directory_, ends[0], child_); error != 0) {
    problem_ = std::strerror(error);
    child_ = 0;
    close(ends[1]);
  } else {
    pipe_ = fdopen(ends[1], "w");
    send("set encoding utf8\nset grid back lt 1 lw 0.5 lc rgb '#d0d0d0'\n");
  }
  close(ends[0]);
}

Gnuplot::~Gnuplot() {
  (void)wait();
}

// Ends the input and waits; returns the child's status.
int Gnuplot::wait() {
  if (pipe_ != nullptr) std::fclose(pipe_);
  pipe_ = nullptr;
  int status = 0;
  if (child_ > 0) {
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) continue;
  }
  child_ = 0;
  return status;
}

void Gnuplot::send(const std::string& text) {
  if (pipe_ != nullptr) std::fwrite(text.data(), 1, text.size(), pipe_);
}

void Gnuplot::draw(const std::string& name, const std::string& plot, int width, int height) {
  if (pipe_ == nullptr) return;
  const std::pair<const char*, std::string> terminals[] = {
      {".svg", fmt::format("svg size {},{} dynamic", width, height)},
      {".png", fmt::format("pngcairo size {},{}", width * 3 / 2, height * 3 / 2)}};
  for (const auto& [ending, terminal] : terminals) {
    const auto path = std::filesystem::path(directory_) / (name + ending);
    files_.push_back(std::make_unique<OutputFile>(path.string()));
    // It runs in the folder, so that a user's path cannot act as a command.
    const auto file = std::filesystem::path(files_.back()->path_while_writing()).filename();
    send(fmt::format("set terminal {} background 'white'\nset output {}\n{}\nunset output\n",
                     terminal, gnuplot_quoted(file.string()), plot));
  }
}

std::vector<std::unique_ptr<OutputFile>> Gnuplot::finish() {
  const int status = wait();
  if (problem_.empty() && status != 0) problem_ = "it failed; see its error message above";
  const char* mend = "install it (Debian package gnuplot-nox)";
  for (const auto& file : files_) {
    if (!problem_.empty() || is_complete(file->path_while_writing())) continue;
    problem_ = file->path() + " is not complete";
    mend = "free space on the disk";
  }
  if (!problem_.empty()) {
    note_failure(problem_, mend);
    return {};
  }
  for (const auto& file : files_) file->close();
  return std::move(files_);
}

}  // namespace condyle::host
