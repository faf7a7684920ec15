// SPDX-License-Identifier: Apache-2.0
#include "recordings/file_digest.h"

#include <fmt/format.h>

#include <array>
#include <boost/uuid/detail/sha1.hpp>
#include <fstream>

#include "hosted/files/input_error.h"

namespace condyle::host {

std::string file_digest(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  boost::uuids::detail::sha1 digest;
  std::array<char, 65536> bytes;
  while (file.read(bytes.data(), bytes.size()) || file.gcount() > 0) {
    digest.process_bytes(bytes.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) throw InputError(path, "cannot be read", "check its name and its permissions");
  boost::uuids::detail::sha1::digest_type words;
  digest.get_digest(words);
  std::string text;
  for (const unsigned int word : words) text += fmt::format("{:08x}", word);
  return text;
}

}  // namespace condyle::host
