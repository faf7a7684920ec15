// SPDX-License-Identifier: Apache-2.0
#include "hosted/files/text_file.h"

#include "hosted/files/byte_reader.h"
#include "hosted/files/input_error.h"

namespace condyle::host {

std::string read_text_file(const std::string& path) {
  ByteReader reader(path);
  const std::string_view content = reader.peek(ByteReader::kLongestLine);
  if (content.size() == ByteReader::kLongestLine) {
    throw InputError(path, "is longer than a megabyte", "name a text file of at most a megabyte");
  }
  return std::string(content);
}

std::string read_text_line(const std::string& path) {
  std::string text = read_text_file(path);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text;
}

}  // namespace condyle::host
