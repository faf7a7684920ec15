// SPDX-License-Identifier: Apache-2.0
// Any bytes as a file of muscles: what is accepted is in its ranges, all else is refused with a
// message.
#include <cmath>

#include "fuzz/lines.h"
#include "fuzz/memory_file.h"
#include "hosted/files/input_error.h"
#include "protocols/emg/muscle_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace condyle;
  const fuzz::MemoryFile file(data, size);
  try {
    const host::MuscleFile muscles = host::load_muscles(file.path());
    const std::size_t count = muscles.channels.size();
    if (count == 0 || count > kMostMuscles || muscles.set.count != count) std::abort();
    for (std::size_t i = 0; i < count; ++i) {
      if (!(muscles.set.muscle[i].maximum_force_N > 0)) std::abort();
      if (!(std::abs(muscles.set.muscle[i].arm) <= 1)) std::abort();
      if (!(muscles.channels[i].maximum > 0)) std::abort();
    }
  } catch (const host::InputError& error) {
    fuzz::require_clean(error.what());
  }
  return 0;
}
