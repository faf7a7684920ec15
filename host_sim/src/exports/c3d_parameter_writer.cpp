// SPDX-License-Identifier: Apache-2.0
#include "exports/c3d_parameter_writer.h"

#include <algorithm>
#include <bit>

namespace condyle::host {
namespace {

constexpr std::size_t kBlock = 512, kMostItems = 255;
constexpr char kIntel = 84, kKey = 0x50;

void append_byte(std::string& bytes, std::size_t value) {
  bytes += static_cast<char>(static_cast<unsigned char>(value));
}

}  // namespace

void append_c3d_word(std::string& bytes, std::uint64_t value) {
  append_byte(bytes, value & 0xffU);
  append_byte(bytes, value >> 8U & 0xffU);
}

void append_c3d_float(std::string& bytes, double value) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  append_c3d_word(bytes, bits & 0xffffU);
  append_c3d_word(bytes, bits >> 16U);
}

void fill_c3d_block(std::string& bytes) {
  bytes.resize((bytes.size() + kBlock - 1) / kBlock * kBlock, '\0');
}

void C3dParameterWriter::group(std::string_view name) {
  ++groups_;
  append_byte(records_, name.size());
  append_byte(records_, static_cast<std::size_t>(256 - groups_));
  records_ += name;
  append_c3d_word(records_, 2 + 1);  // to the next record: this word and an empty description
  append_byte(records_, 0);
}

void C3dParameterWriter::start(std::string_view name, int type, const std::vector<int>& shape,
                               std::size_t size) {
  append_byte(records_, name.size());
  append_byte(records_, static_cast<std::size_t>(groups_));
  records_ += name;
  append_c3d_word(records_, 2 + 2 + shape.size() + size + 1);
  append_byte(records_, static_cast<std::size_t>(type + 256) & 0xffU);
  append_byte(records_, shape.size());
  for (const int length : shape) append_byte(records_, static_cast<std::size_t>(length));
}

void C3dParameterWriter::word(std::string_view name, std::uint64_t value) {
  start(name, 2, {}, 2);
  append_c3d_word(records_, value);
  append_byte(records_, 0);
}

void C3dParameterWriter::words(std::string_view name, const std::vector<std::uint64_t>& values) {
  start(name, 2, {static_cast<int>(values.size())}, 2 * values.size());
  for (const std::uint64_t value : values) append_c3d_word(records_, value);
  append_byte(records_, 0);
}

void C3dParameterWriter::floats(std::string_view name, const std::vector<int>& shape,
                                const std::vector<double>& values) {
  start(name, 4, shape, 4 * values.size());
  for (const double value : values) append_c3d_float(records_, value);
  append_byte(records_, 0);
}

void C3dParameterWriter::text(std::string_view name, const std::string& value) {
  const std::string cut = value.substr(0, kMostItems);
  start(name, -1, {static_cast<int>(cut.size())}, cut.size());
  records_ += cut;
  append_byte(records_, 0);
}

void C3dParameterWriter::texts(std::string_view name, const std::vector<std::string>& values) {
  std::size_t length = 1;
  for (const std::string& value : values) length = std::max(length, value.size());
  for (std::size_t first = 0, part = 1; first == 0 || first < values.size();
       first += kMostItems, ++part) {
    const std::size_t count = std::min(kMostItems, values.size() - first);
    start(part == 1 ? std::string(name) : std::string(name) + std::to_string(part), -1,
          {static_cast<int>(length), static_cast<int>(count)}, length * count);
    for (std::size_t i = first; i < first + count; ++i) {
      std::string padded = values[i];
      padded.resize(length, ' ');
      records_ += padded;
    }
    append_byte(records_, 0);
  }
}

std::string C3dParameterWriter::section() const {
  std::string bytes{1, kKey, 0, kIntel};
  bytes += records_;
  append_c3d_word(bytes, 0);  // a record without name ends the section
  fill_c3d_block(bytes);
  const std::size_t blocks = bytes.size() / kBlock;
  if (blocks > kMostItems) return {};
  bytes[2] = static_cast<char>(static_cast<unsigned char>(blocks));
  return bytes;
}

}  // namespace condyle::host
