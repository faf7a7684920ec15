// SPDX-License-Identifier: Apache-2.0
// Any bytes as what a box answers to `condyle session`: a box's words, or refused with a message.
#include "commands/box_answer.h"
#include "fuzz/lines.h"
#include "hosted/files/input_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace condyle;
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data + 1), size - 1);
  const int status = (data[0] & 1U) != 0 ? 200 : 503;
  try {
    const std::string words = host::read_command_answer("box", status, text);
    if (status != 200 || host::clean_line(words) != words) std::abort();
  } catch (const host::InputError& error) {
    fuzz::require_clean(error.what());
  }
  try {
    if (host::read_status_answer("box", status, text) != text || status != 200) std::abort();
  } catch (const host::InputError& error) {
    fuzz::require_clean(error.what());
  }
  return 0;
}
