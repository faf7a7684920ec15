// SPDX-License-Identifier: Apache-2.0
#include "comparison/figure_label.h"

#include <vector>

namespace condyle::host {

std::string figure_label(const std::string& text, std::size_t longest) {
  std::vector<std::string> characters;
  for (const char c : text) {
    const bool continues = (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
    if (!continues || characters.empty()) characters.emplace_back();
    characters.back() += c;
  }
  if (characters.size() <= longest) return text;
  const std::size_t kept = longest - 3, head = kept / 2;
  std::string label;
  for (std::size_t i = 0; i < head; ++i) label += characters[i];
  label += "...";
  for (std::size_t i = characters.size() - (kept - head); i < characters.size(); ++i) {
    label += characters[i];
  }
  return label;
}

}  // namespace condyle::host
