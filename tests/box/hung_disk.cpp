// SPDX-License-Identifier: Apache-2.0
// To be preloaded: while the file that CONDYLE_HUNG_DISK names is there, statvfs and whatever
// writes into a regular file do not return, as on a network's disk that went away.
#include <dlfcn.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cstdlib>

namespace {

void hang() {
  const char* const flag = std::getenv("CONDYLE_HUNG_DISK");
  while (flag != nullptr && access(flag, F_OK) == 0) usleep(10'000);
}

bool is_file(int descriptor) {
  struct stat status {};
  return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && descriptor > 2;
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int statvfs(const char* path, struct statvfs* status) {
  hang();
  return next<decltype(statvfs)>("statvfs")(path, status);
}

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  if (is_file(descriptor)) hang();
  return next<decltype(write)>("write")(descriptor, bytes, size);
}

int fdatasync(int descriptor) {
  if (is_file(descriptor)) hang();
  return next<decltype(fdatasync)>("fdatasync")(descriptor);
}

}  // extern "C"
