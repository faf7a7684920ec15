// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "condyle/hal/log/mcap_writer.h"

namespace condyle::hal {

/// The index of a session log in an unnamed file on the log's disk: it takes no memory, and a crash
/// leaves nothing of it. If the disk does not support such files, memory holds the index.
class IndexFile final : public McapIndexStore {
 public:
  explicit IndexFile(const std::string& log) {
    const std::string folder = std::filesystem::path(log).parent_path().string();
    descriptor_ = ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC,
                         S_IRUSR | S_IWUSR);
  }
  ~IndexFile() override {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  IndexFile(const IndexFile&) = delete;
  IndexFile& operator=(const IndexFile&) = delete;

  bool append(std::uint64_t offset, std::span<const std::uint8_t> bytes) override {
    return all(bytes, offset, ::pwrite);
  }
  bool read(std::uint64_t offset, std::span<std::uint8_t> bytes) override {
    return all(bytes, offset, ::pread);
  }

 private:
  template <class Bytes, class Move>
  bool all(Bytes bytes, std::uint64_t offset, Move move) {
    while (!bytes.empty()) {
      const ssize_t moved =
          move(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
      if (moved < 0 && errno == EINTR) continue;
      if (moved <= 0) return false;
      bytes = bytes.subspan(static_cast<std::size_t>(moved));
      offset += static_cast<std::uint64_t>(moved);
    }
    return true;
  }

  int descriptor_ = -1;
};

}  // namespace condyle::hal
