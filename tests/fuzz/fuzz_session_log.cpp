// SPDX-License-Identifier: Apache-2.0
// Any bytes as a session log, or as the inside of a chunk with the right checksum: read to an end,
// refused or cut short with a reason, nothing else.
#include <zlib.h>

#include "condyle/hal/facebow.h"
#include "condyle/hal/session_log_source.h"
#include "fuzz/memory_file.h"
#include "session_log/session.h"

namespace {

using condyle::hal::McapRead;
using condyle::hal::Status;

// A log's bytes up to its first chunk.
const std::string& start_of_log() {
  static const std::string start = [] {
    const std::string path = "/tmp/fuzz_session_log_" + std::to_string(getpid());
    condyle::hal::SessionLogWriter log;
    if (log.open(path, condyle::testing_support::make_header(2)) !=
        condyle::hal::SessionLogFailure::none) {
      std::abort();
    }
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

std::string in_a_chunk(const std::uint8_t* data, std::size_t size) {
  const std::string content =
      std::string(16, '\0') + number<std::uint64_t>(size) +
      number(static_cast<std::uint32_t>(crc32(0, data, static_cast<uInt>(size)))) +
      number<std::uint32_t>(0) + number<std::uint64_t>(size) +
      std::string(reinterpret_cast<const char*>(data), size);
  return start_of_log() + '\x06' + number<std::uint64_t>(content.size()) + content;
}

void read(const std::string& path) {
  condyle::hal::SessionLogSource source(path);
  condyle::hal::RawReport report;
  Status status = source.open();
  if (status != Status::ok && source.problem().empty()) std::abort();
  while (status == Status::ok || status == Status::disconnected) {
    if (status == Status::disconnected && source.open() != Status::ok) std::abort();
    status = source.read(condyle::hal::kNoDeadline, report);
    if (report.size > condyle::hal::kMaxReportSize) std::abort();
  }
  condyle::hal::McapReader reader({.record_bytes = 65'536, .chunk_bytes = 65'536});
  if (reader.open(path) != Status::ok) return;
  condyle::hal::McapRecord record;
  McapRead outcome = McapRead::record;
  while (outcome == McapRead::record) outcome = reader.next(record);
  if (outcome != McapRead::end && reader.problem().reason.empty()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  if ((data[0] & 1U) != 0) {
    const std::string log = in_a_chunk(data + 1, size - 1);
    read(condyle::fuzz::MemoryFile(reinterpret_cast<const std::uint8_t*>(log.data()), log.size())
             .path());
  } else {
    read(condyle::fuzz::MemoryFile(data + 1, size - 1).path());
  }
  return 0;
}
