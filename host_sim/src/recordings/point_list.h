// SPDX-License-Identifier: Apache-2.0
// Names of points in a message.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace condyle::host {

/// The first items as `text` gives them, so that a file with very many gives a short message.
template <typename Items, typename Text>
std::string short_list(const Items& items, std::string_view separator, Text text) {
  constexpr std::size_t kMostListed = 12;
  std::string words;
  for (std::size_t i = 0; i < std::min(items.size(), kMostListed); ++i) {
    if (i > 0) words += separator;
    words += text(items[i]);
  }
  if (items.size() > kMostListed) {
    words += fmt::format(" and {} more", items.size() - kMostListed);
  }
  return words;
}

/// "A, B, C and 4 more".
inline std::string list_of_points(const std::vector<std::string>& names) {
  return short_list(names, ", ", [](const std::string& name) {
    return name.empty() ? std::string("(without a name)") : name;
  });
}

}  // namespace condyle::host
