// SPDX-License-Identifier: Apache-2.0
// Any bytes as the box's configuration: what is accepted opens it to this machine alone or asks for
// a token, all else is refused with a message.
#include "box/configuration.h"
#include "fuzz/lines.h"
#include "fuzz/memory_file.h"
#include "hosted/files/input_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace condyle;
  const fuzz::MemoryFile file(data, size);
  try {
    const box::Configuration configuration = box::load_configuration(file.path());
    if (configuration.token.empty() && !box::is_loopback(configuration.http_address)) std::abort();
    if (configuration.facebow.file.empty() || configuration.most_listeners == 0) std::abort();
    if (configuration.companions.size() > 6) std::abort();
  } catch (const host::InputError& error) {
    fuzz::require_clean(error.what());
  }
  return 0;
}
