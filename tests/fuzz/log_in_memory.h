// SPDX-License-Identifier: Apache-2.0
// A session log made of a fuzzer's bytes.
#pragma once

#include <unistd.h>
#include <zlib.h>

#include <cstdio>
#include <string>

#include "condyle/hal/log/session_log.h"
#include "fuzz/memory_file.h"
#include "support/session.h"

namespace condyle::fuzz {

/// A log's bytes up to its first chunk.
inline const std::string& start_of_log() {
  static const std::string start = [] {
    const std::string path = "/tmp/condyle_fuzz_log_" + std::to_string(getpid());
    condyle::hal::SessionLogWriter log;
    hal::SessionHeader header = testing_support::make_header(2);
    header.sources.push_back({hal::kMarkerSource, 0, 0, "", {}});
    if (log.open(path, header) != hal::SessionLogFailure::none) std::abort();
    std::string content(log.status().bytes_written, '\0');
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (file == nullptr || std::fread(content.data(), 1, content.size(), file) != content.size()) {
      std::abort();
    }
    std::fclose(file);
    unlink(path.c_str());
    return content;
  }();
  return start;
}

template <typename Number>
std::string number(Number value) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i));
  }
  return bytes;
}

inline std::string in_a_chunk(const std::uint8_t* data, std::size_t size) {
  const std::string content =
      std::string(16, '\0') + number<std::uint64_t>(size) +
      number(static_cast<std::uint32_t>(crc32(0, data, static_cast<uInt>(size)))) +
      number<std::uint32_t>(0) + number<std::uint64_t>(size) +
      std::string(reinterpret_cast<const char*>(data), size);
  return start_of_log() + '\x06' + number<std::uint64_t>(content.size()) + content;
}

/// By the first byte: the rest as a whole log, or as the inside of a chunk with the right checksum.
class LogInMemory {
 public:
  LogInMemory(const std::uint8_t* data, std::size_t size)
      : bytes_((data[0] & 1U) != 0
                   ? in_a_chunk(data + 1, size - 1)
                   : std::string(reinterpret_cast<const char*>(data + 1), size - 1)),
        file_(reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size()) {}
  std::string path() const { return file_.path(); }

 private:
  std::string bytes_;
  MemoryFile file_;
};

}  // namespace condyle::fuzz
