// SPDX-License-Identifier: Apache-2.0
#include "hosted/files/nearest_word.h"

#include <algorithm>
#include <numeric>

namespace condyle::host {

std::string nearest_word(const std::string& word, const std::vector<std::string>& words) {
  // Number of insertions, deletions and substitutions (Levenshtein); a swap of neighbours counts as
  // one.
  const auto distance = [](const std::string& a, const std::string& b) {
    std::vector<std::size_t> before_last, last, now(b.size() + 1);
    std::iota(now.begin(), now.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
      before_last = last;
      last = now;
      now[0] = i;
      for (std::size_t j = 1; j <= b.size(); ++j) {
        now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
        if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
          now[j] = std::min(now[j], before_last[j - 2] + 1);
        }
      }
    }
    return now.back();
  };
  std::string nearest;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& known : words) {
    const std::size_t d = distance(word, known);
    if (d < least) least = d, nearest = known;
  }
  if (!nearest.empty()) return nearest;
  // A common beginning also counts, as in --figure and --figures, or --output and --out.
  for (const std::string& known : words) {
    const std::size_t common = std::min(known.size(), word.size());
    if (common >= 4 && known.compare(0, common, word, 0, common) == 0) return known;
  }
  return nearest;
}

}  // namespace condyle::host
