// SPDX-License-Identifier: Apache-2.0
// Makes text from a file, a device, a server or a command line safe to show.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace condyle::host {

namespace internal {

/// Number of bytes of the UTF-8 character at the start of `text`, which must not be empty, and its
/// code; 0 if it is invalid (overlong, a surrogate, beyond U+10FFFF, or cut short).
struct Utf8Character {
  std::size_t bytes = 0;
  std::uint32_t code = 0;
};
inline Utf8Character first_character(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::uint32_t lead = byte(0);
  if (lead < 0x80) return {1, lead};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
  std::uint32_t code = lead & (0x7fU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return {};
    code = code << 6U | (byte(i) & 0x3fU);
  }
  constexpr std::array<std::uint32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
  if (code < kLeast[bytes] || code > 0x10ffff || is_surrogate) return {};
  return {bytes, code};
}

/// True if it moves a terminal's cursor, ends a line or changes the direction of writing.
inline bool is_control(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x061c ||
         (code >= 0x200e && code <= 0x200f) || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069) || code == 0xfeff;
}

inline std::string cleaned(std::string_view text, bool keeps_lines) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string result;
  while (!text.empty()) {
    const Utf8Character character = first_character(text);
    const std::size_t bytes = character.bytes > 0 ? character.bytes : 1;
    const bool is_kept = character.bytes > 0 &&
                         (!is_control(character.code) || (keeps_lines && character.code == '\n'));
    for (const char c : text.substr(0, bytes)) {
      const auto byte = static_cast<unsigned char>(c);
      if (is_kept) {
        result += c;
      } else {
        result += {'\\', 'x', kDigits[byte >> 4U], kDigits[byte & 15U]};
      }
    }
    text.remove_prefix(bytes);
  }
  return result;
}

}  // namespace internal

/// One line: control characters, characters that change the direction of writing, and invalid UTF-8
/// become \xNN.
inline std::string clean_line(std::string_view text) {
  return internal::cleaned(text, false);
}

/// The same, but keeps line feeds.
inline std::string clean_lines(std::string_view text) {
  return internal::cleaned(text, true);
}

/// A CSV cell in quotation marks, on one line. A cell that a spreadsheet would take for a formula
/// begins with an apostrophe.
inline std::string csv_cell(std::string_view text) {
  constexpr std::string_view kFormula = "=+-@";
  std::string result = "\"";
  if (!text.empty() && kFormula.find(text.front()) != std::string_view::npos) result += '\'';
  for (const char c : clean_line(text)) result += c == '"' ? "\"\"" : std::string(1, c);
  return result + '"';
}

/// A CSV cell, in quotation marks only if it needs them.
inline std::string csv_field(std::string_view text) {
  std::string cell = csv_cell(text);
  const bool is_plain = cell.size() == text.size() + 2 && cell.substr(1, text.size()) == text &&
                        text.find_first_of(",\"") == std::string_view::npos;
  return is_plain ? std::string(text) : cell;
}

}  // namespace condyle::host
