// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace condyle::host {

/// Something the user gave cannot be used: says where, what is wrong and how to mend it. The
/// command prints it and exits with 2.
class InputError : public std::runtime_error {
 public:
  /// A message that has it all.
  explicit InputError(const std::string& message) : std::runtime_error(printable(message)) {}
  /// `where`: "FILE", "FILE:LINE" or "FILE:LINE: column NAME". Control characters, which may come
  /// from the input itself, are shown as \xNN.
  InputError(const std::string& where, const std::string& problem, const std::string& mend)
      : std::runtime_error(printable(where + ": " + problem + (mend.empty() ? "" : "; " + mend))) {}

 private:
  static std::string printable(const std::string& text) {
    std::string result;
    for (const char c : text) {
      const auto byte = static_cast<unsigned char>(c);
      if (byte >= 0x20 && byte != 0x7f) {
        result += c;
      } else {
        constexpr const char* digits = "0123456789abcdef";
        result += {'\\', 'x', digits[byte >> 4U], digits[byte & 15U]};
      }
    }
    return result;
  }
};

}  // namespace condyle::host
