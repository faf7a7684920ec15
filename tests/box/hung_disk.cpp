// SPDX-License-Identifier: Apache-2.0
// To be preloaded: a disk that fails while the file that CONDYLE_HUNG_DISK names is there. What it
// holds says how. Nothing: statvfs and what writes into a regular file do not return, as on a
// network's disk that went away. "slow MS": they take so long. "errno NUMBER": they fail, as do
// the opening of a new file and the look for one.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>

namespace {

// Returns 0 where the call may go on, or the error that it is to fail with.
int disturbed() {
  const char* const flag = std::getenv("CONDYLE_HUNG_DISK");
  if (flag == nullptr) return 0;
  for (;;) {
    const long descriptor = syscall(SYS_openat, AT_FDCWD, flag, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return 0;
    char text[32] = {};
    const long size = syscall(SYS_read, descriptor, text, sizeof text - 1);
    syscall(SYS_close, descriptor);
    if (size > 0 && std::strncmp(text, "errno ", 6) == 0) return std::atoi(text + 6);
    if (size > 0 && std::strncmp(text, "slow ", 5) == 0) {
      usleep(static_cast<useconds_t>(std::atoi(text + 5)) * 1000);
      return 0;
    }
    usleep(10'000);
  }
}

bool fails() {
  const int error = disturbed();
  if (error != 0) errno = error;
  return error != 0;
}

bool is_file(int descriptor) {
  struct stat status {};
  return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && descriptor > 2;
}

bool is_log(const char* path) {
  const std::size_t length = std::strlen(path);
  return length > 5 && std::strcmp(path + length - 5, ".mcap") == 0;
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int statvfs(const char* path, struct statvfs* status) {
  if (fails()) return -1;
  return next<decltype(statvfs)>("statvfs")(path, status);
}

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  if (is_file(descriptor) && fails()) return -1;
  return next<decltype(write)>("write")(descriptor, bytes, size);
}

int fdatasync(int descriptor) {
  if (is_file(descriptor) && fails()) return -1;
  return next<decltype(fdatasync)>("fdatasync")(descriptor);
}

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const auto mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  if ((flags & O_CREAT) != 0 && is_log(path) && fails()) return -1;
  return next<decltype(open)>("open")(path, flags, mode);
}

int lstat(const char* path, struct stat* status) {
  if (is_log(path) && fails()) return -1;
  return next<decltype(lstat)>("lstat")(path, status);
}

}  // extern "C"
