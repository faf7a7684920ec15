// SPDX-License-Identifier: Apache-2.0
// Any bytes as a parameter file: what is accepted is valid, all else is refused with a message.
#include "fuzz/memory_file.h"
#include "hosted/config/parameter_file.h"
#include "hosted/files/input_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const condyle::fuzz::MemoryFile file(data, size);
  try {
    if (!condyle::is_valid(condyle::host::load_parameters(file.path()).values)) std::abort();
  } catch (const condyle::host::InputError&) {
  }
  try {
    if (!condyle::is_valid(condyle::host::load_recommended_parameters(file.path()))) std::abort();
  } catch (const condyle::host::InputError&) {
  }
  return 0;
}
