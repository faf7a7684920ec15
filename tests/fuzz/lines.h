// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include "hosted/files/clean_text.h"

namespace condyle::fuzz {

/// Aborts where `text` would do more than be read: on a terminal, in a table.
inline void require_clean(const std::string& text) {
  if (host::clean_lines(text) != text) std::abort();
}

/// The parts of the fuzzer's bytes between `end`; the last one holds the rest.
inline std::vector<std::string> parts(const std::uint8_t* data, std::size_t size, char end,
                                      std::size_t most) {
  std::vector<std::string> found(1);
  for (std::size_t i = 0; i < size; ++i) {
    const char c = static_cast<char>(data[i]);
    if (c == end && found.size() < most) {
      found.emplace_back();
    } else {
      found.back() += c;
    }
  }
  found.resize(most);
  return found;
}

}  // namespace condyle::fuzz
