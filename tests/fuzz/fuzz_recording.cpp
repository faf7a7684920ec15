// SPDX-License-Identifier: Apache-2.0
// Any bytes as a recording: read through the cascade or refused with a message, nothing else.
#include <cmath>

#include "condyle/estimator/published_cascade.h"
#include "fuzz/memory_file.h"
#include "input_error.h"
#include "recording.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  condyle::host::RecordingOptions options;
  options.faults =
      (data[0] & 1U) != 0 ? condyle::host::FaultPolicy::event : condyle::host::FaultPolicy::refuse;
  if ((data[0] & 2U) != 0) options.units_per_metre = 1000;
  const condyle::fuzz::MemoryFile file(data + 1, size - 1);
  try {
    const auto recording = condyle::host::open_recording(file.path(), options);
    condyle::PublishedCascade<double> cascade(condyle::PublishedParameters{});
    condyle::SampleChecker checker(16'666'667);
    condyle::Sample sample;
    while (recording->next(sample)) {
      static_cast<void>(checker.check(sample));
      if (!sample.position_valid) continue;
      for (std::size_t i = 0; i < condyle::coordinate_count(sample.kind); ++i) {
        if (!std::isfinite(sample.coordinates[i])) std::abort();
      }
      static_cast<void>(cascade.step(condyle::followed_position_m(sample, {})));
    }
  } catch (const condyle::host::InputError&) {
  }
  return 0;
}
