// SPDX-License-Identifier: Apache-2.0
#include "recordings/utf8_name.h"

#include "hosted/files/clean_text.h"

namespace condyle::host {

std::string utf8_name(std::string name) {
  bool is_utf8 = true;
  std::string_view rest = name;
  while (is_utf8 && !rest.empty()) {
    const std::size_t bytes = internal::first_character(rest).bytes;
    is_utf8 = bytes > 0;
    rest.remove_prefix(bytes);
  }
  if (is_utf8) return name;
  std::string result;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80 && byte < 0xa0) return name;
    if (byte < 0x80) {
      result += c;
    } else {
      result += static_cast<char>(0xc0U | byte >> 6U);
      result += static_cast<char>(0x80U | (byte & 0x3fU));
    }
  }
  return result;
}

}  // namespace condyle::host
