// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string_view>

namespace condyle::box {

/// How the name of a session log ends.
inline constexpr std::string_view kSessionFileEnd = ".mcap";

/// True for the names that the box gives to session logs: letters, digits, - and _, then .mcap.
inline bool is_session_file(std::string_view name) {
  constexpr std::size_t kLongest = 128;
  if (name.size() > kLongest || !name.ends_with(kSessionFileEnd) ||
      name.size() == kSessionFileEnd.size()) {
    return false;
  }
  name.remove_suffix(kSessionFileEnd.size());
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
  });
}

}  // namespace condyle::box
