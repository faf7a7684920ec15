// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace condyle::host {

/// The word of `words` closest to `word`, if at most a third of it is mistyped. Empty: none is
/// close.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words);

}  // namespace condyle::host
