// SPDX-License-Identifier: Apache-2.0
#include "options/shard_option.h"

#include <algorithm>
#include <charconv>

#include "hosted/files/input_error.h"

namespace condyle::host {

std::pair<std::uint64_t, std::uint64_t> parse_shard(const std::string& text) {
  std::uint64_t number = 0, count = 0;
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto read = [&](std::size_t begin, std::size_t end, std::uint64_t& value) {
    if (begin >= end) return false;
    const auto [stop, error] = std::from_chars(text.data() + begin, text.data() + end, value);
    return error == std::errc() && stop == text.data() + end;
  };
  if (!read(0, slash, number) || !read(slash + 1, text.size(), count) || number < 1 ||
      number > count) {
    throw InputError("--shard " + text, "is not a shard", "give I/N, I from 1 to N, as in 1/4");
  }
  return {number, count};
}

}  // namespace condyle::host
