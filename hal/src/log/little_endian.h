// SPDX-License-Identifier: Apache-2.0
// Numbers and strings as MCAP stores them: little endian, strings preceded by their uint32 length.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace condyle::hal {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

/// `size` as an address in memory; it must fit.
constexpr std::size_t to_size(unsigned long long size) {
  return static_cast<std::size_t>(size);
}

/// The bytes of `text`.
inline ByteSpan bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// `bytes` as text.
inline std::string_view text_of(ByteSpan bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Writes `value` at `place`, which has sizeof(value) bytes.
template <std::unsigned_integral Number>
void store_little_endian(std::uint8_t* place, Number value) {
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    place[i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

/// Appends `value` to `out`.
template <std::unsigned_integral Number>
void append_number(Bytes& out, Number value) {
  out.resize(out.size() + sizeof(Number));
  store_little_endian(out.data() + out.size() - sizeof(Number), value);
}

/// Appends `bytes` to `out`.
inline void append_bytes(Bytes& out, ByteSpan bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

/// Appends the length of `text` and `text`.
inline void append_string(Bytes& out, std::string_view text) {
  append_number(out, static_cast<std::uint32_t>(text.size()));
  append_bytes(out, bytes_of(text));
}

/// Takes numbers and strings from the front of some bytes. Missing ones read as zero or empty, and
/// `ok()` is false from then on.
class ByteParser {
 public:
  explicit ByteParser(ByteSpan bytes) : rest_(bytes) {}

  template <std::unsigned_integral Number>
  Number number() {
    std::uint64_t value = 0;
    const ByteSpan bytes = take(sizeof(Number));
    for (std::size_t i = 0; i < bytes.size(); ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
    return static_cast<Number>(value);
  }
  /// The next `size` bytes.
  ByteSpan take(std::uint64_t size) {
    if (size > rest_.size()) {
      ok_ = false;
      rest_ = {};
      return {};
    }
    const ByteSpan taken = rest_.first(to_size(size));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }
  ByteSpan sized_bytes() { return take(number<std::uint32_t>()); }
  std::string_view string() { return text_of(sized_bytes()); }

  bool ok() const { return ok_; }
  ByteSpan rest() const { return rest_; }

 private:
  ByteSpan rest_;
  bool ok_ = true;
};

}  // namespace condyle::hal
