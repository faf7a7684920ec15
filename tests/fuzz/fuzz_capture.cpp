// SPDX-License-Identifier: Apache-2.0
// Any bytes as a capture of USB traffic: replayed or refused with a reason, nothing else.
#include "condyle/hal/facebow.h"
#include "condyle/hal/log/usbmon_capture.h"
#include "fuzz/memory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using condyle::hal::Status;
  if (size == 0) return 0;
  condyle::hal::UsbmonChoice choice;
  if ((data[0] & 1U) != 0) choice.vendor_id = 0x1209;
  if ((data[0] & 2U) != 0) choice.device = 5;
  const condyle::fuzz::MemoryFile file(data + 1, size - 1);
  condyle::hal::UsbmonCapture capture(file.path(), choice);
  condyle::hal::RawReport report;
  Status status = capture.open();
  if (status != Status::ok && capture.problem().empty()) std::abort();
  while (status == Status::ok || status == Status::disconnected) {
    if (status == Status::disconnected && capture.open() != Status::ok) std::abort();
    status = capture.read(condyle::hal::kNoDeadline, report);
    if (report.size > condyle::hal::kMaxReportSize) std::abort();
  }
  return 0;
}
