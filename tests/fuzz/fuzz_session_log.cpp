// SPDX-License-Identifier: Apache-2.0
// Any bytes as a session log, or as the inside of a chunk with the right checksum: read to an end,
// refused or cut short with a reason, nothing else.
#include "condyle/hal/facebow.h"
#include "condyle/hal/log/session_log_source.h"
#include "fuzz/log_in_memory.h"

namespace {

using condyle::hal::McapRead;
using condyle::hal::Status;

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
  if (size > 0) read(condyle::fuzz::LogInMemory(data, size).path());
  return 0;
}
