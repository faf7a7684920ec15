// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/inotify.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "fake/file_handle.h"
#include "hosted/files/input_error.h"

namespace condyle::hil {

/// Counts how often a file was read and closed again, by any program.
class Looks {
 public:
  explicit Looks(const std::filesystem::path& file)
      : events_(inotify_init1(IN_CLOEXEC | IN_NONBLOCK)) {
    if (inotify_add_watch(events_.get(), file.c_str(), IN_CLOSE_NOWRITE) < 0) {
      throw host::InputError(file.string(),
                             std::string("cannot be watched: ") + std::strerror(errno),
                             "raise fs.inotify.max_user_watches or max_user_instances");
    }
  }

  /// Since the beginning.
  int count() {
    inotify_event event{};  // of a file, which has no name in it
    while (read(events_.get(), &event, sizeof event) == sizeof event) ++count_;
    return count_;
  }

 private:
  host::fake::FileHandle events_;
  int count_ = 0;
};

}  // namespace condyle::hil
