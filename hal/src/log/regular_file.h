// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/stat.h>
#ifndef _WIN32
#include <fcntl.h>
#include <unistd.h>
#endif

#include <cerrno>
#include <cstdint>
#include <cstdio>

namespace condyle::hal {

/// Opens a file for reading, but no pipe: opening one would wait for its other end. Null with errno
/// on failure.
inline std::FILE* open_without_waiting(const char* path) {
#ifdef _WIN32
  return std::fopen(path, "rb");
#else
  const int descriptor = ::open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return nullptr;
  std::FILE* const file = fdopen(descriptor, "rb");
  if (file == nullptr) ::close(descriptor);
  return file;
#endif
}

/// True for a file with a size, which it sets; false for a folder, a pipe or a device.
inline bool is_regular_file(std::FILE* file, std::uint64_t& size) {
  struct stat information {};
  if (fstat(fileno(file), &information) != 0 || !S_ISREG(information.st_mode)) return false;
  size = static_cast<std::uint64_t>(information.st_size);
  return true;
}

}  // namespace condyle::hal
