// SPDX-License-Identifier: Apache-2.0
// Any bytes as EMG beside a recording, envelopes or raw: read or refused with a message.
#include <cmath>

#include "fuzz/lines.h"
#include "fuzz/memory_file.h"
#include "hosted/files/input_error.h"
#include "protocols/emg/emg_recording.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace condyle;
  if (size == 0) return 0;
  host::MuscleFile muscles;
  for (const char* name : {"masseter", "digastric"}) {
    muscles.channels.push_back({name, name, 0.5, (data[0] & 4U) != 0});
    ++muscles.set.count;
  }
  host::EmgReading reading;
  reading.faults = (data[0] & 1U) != 0 ? host::FaultPolicy::event : host::FaultPolicy::refuse;
  reading.is_raw = (data[0] & 2U) != 0;
  if ((data[0] & 8U) != 0) reading.raw_maximum = 0.3;
  const fuzz::MemoryFile file(data + 1, size - 1);
  try {
    const host::EmgRecording emg = host::read_emg(file.path(), muscles, reading);
    if (!(emg.rate_Hz > 0) || !std::isfinite(emg.delay_s)) std::abort();
    for (const host::EmgRow& row : emg.rows) {
      if (std::isinf(row.excitation[0]) || std::isinf(row.excitation[1])) std::abort();
    }
  } catch (const host::InputError& error) {
    fuzz::require_clean(error.what());
  }
  return 0;
}
