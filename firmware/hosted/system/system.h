// SPDX-License-Identifier: Apache-2.0
// What Linux and Windows do differently, for programs that read and write files.
// system_posix.cpp and system_windows.cpp implement it.
#pragma once

#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <thread>

namespace condyle::host {

/// For the start of a program: calls `stop`, from a signal's handler or from a thread, when the
/// user asks the program to end. A pipe without reader and a full file are reported as errors of
/// the write. On Windows, files and pipes carry the bytes unchanged, and consoles show UTF-8.
void prepare_program(void (*stop)(int));

/// Ends a write in which `thread` waits for a reader.
void interrupt_write(std::thread& thread);

/// The standard output, for writing under another handle. Null with errno on failure.
std::FILE* duplicate_standard_output();

/// False for a pipe, a terminal or a device, whose reader may stall.
bool is_on_disk(std::FILE* file);

/// A new file beside `path`, for writing, with the permissions of `path` or of a new file. `path`
/// becomes its name. Null with errno on failure.
std::FILE* make_file_beside(std::string& path);

/// Closing `file` then discards what no reader takes, and does not wait.
void discard_unread(std::FILE* file);

/// Jobs in processes of their own, so that a crash or a lack of memory ends one job only. On
/// Windows, the jobs run in this process, each within `start`.
class JobProcesses {
 public:
  /// How a job ended.
  struct Ended {
    long id = 0;
    std::optional<int> exit_code;
    int signal = 0;  ///< if there is no exit code
  };

  JobProcesses() = default;
  /// Ends all jobs.
  ~JobProcesses() { end_all(); }
  JobProcesses(const JobProcesses&) = delete;
  JobProcesses& operator=(const JobProcesses&) = delete;

  /// Starts `job`, which returns its exit code and throws nothing. Gives the job's id; nothing,
  /// with errno, if no process can be started.
  std::optional<long> start(const std::function<int()>& job);
  /// A job that has ended since, or nothing.
  std::optional<Ended> take_ended();
  /// Ends all jobs, and waits until they are gone.
  void end_all();

 private:
  // The jobs that were started and not taken, with the exit codes of those that ended within
  // `start`.
  std::map<long, std::optional<int>> jobs_;
};

}  // namespace condyle::host
