// SPDX-License-Identifier: Apache-2.0
#include "inspect/descriptor_file.h"

#include <algorithm>
#include <charconv>

#include "hosted/files/byte_reader.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

constexpr std::string_view kBetweenBytes = " \t\r\n,";

bool is_hexadecimal_text(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdefABCDEFxX";
  return std::all_of(bytes.begin(), bytes.end(), [&](char c) {
    return kDigits.find(c) != std::string_view::npos ||
           kBetweenBytes.find(c) != std::string_view::npos;
  });
}

// Appends the bytes of one word: "0x5", "5", "05", "0501...".
bool append_word(std::string_view word, std::vector<std::uint8_t>& bytes) {
  if (word.starts_with("0x") || word.starts_with("0X")) {
    word.remove_prefix(2);
    if (word.empty() || word.size() > 2) return false;
  }
  if (word.size() > 1 && word.size() % 2 != 0) return false;
  while (!word.empty()) {
    const std::string_view digits = word.substr(0, 2);
    std::uint8_t byte = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
    if (error != std::errc() || end != digits.data() + digits.size()) return false;
    bytes.push_back(byte);
    word.remove_prefix(digits.size());
  }
  return true;
}

}  // namespace

std::vector<std::uint8_t> read_descriptor_file(const std::string& path) {
  ByteReader reader(path);
  const std::string_view content = reader.peek(ByteReader::kLongestLine);
  if (content.size() == ByteReader::kLongestLine) {
    throw InputError(path, "is longer than any report descriptor", "give only the descriptor");
  }
  std::vector<std::uint8_t> bytes;
  if (content.empty() || !is_hexadecimal_text(content)) {
    bytes.assign(content.begin(), content.end());
    return bytes;
  }
  std::size_t begin = 0;
  while ((begin = content.find_first_not_of(kBetweenBytes, begin)) != std::string_view::npos) {
    const std::size_t end = std::min(content.find_first_of(kBetweenBytes, begin), content.size());
    const std::string_view word = content.substr(begin, end - begin);
    if (!append_word(word, bytes)) {
      const auto line =
          1 + std::count(content.begin(), content.begin() + static_cast<long>(begin), '\n');
      throw InputError(path + ":" + std::to_string(line),
                       "\"" + std::string(word.substr(0, 20)) + "\" is not a hexadecimal byte",
                       "write two digits for each byte, as in 05 01 or 0x05, 0x01");
    }
    begin = end;
  }
  return bytes;
}

}  // namespace condyle::host
