// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace condyle::hal {

/// A short text without heap: ASCII from space to tilde, the rest filled with 0.
using FixedText = std::array<char, 16>;

/// `text`, cut off if it is too long.
constexpr FixedText fixed_text(std::string_view text) {
  FixedText fixed{};
  std::copy_n(text.begin(), std::min(text.size(), fixed.size()), fixed.begin());
  return fixed;
}

/// The text without the padding.
constexpr std::string_view text_of(const FixedText& fixed) {
  const auto* const end = std::find(fixed.begin(), fixed.end(), '\0');
  return {fixed.data(), static_cast<std::size_t>(end - fixed.begin())};
}

/// True if it is valid as FixedText describes.
constexpr bool is_plain(const FixedText& fixed) {
  const std::string_view text = text_of(fixed);
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; }) &&
         std::all_of(fixed.begin() + text.size(), fixed.end(), [](char c) { return c == '\0'; });
}

}  // namespace condyle::hal
