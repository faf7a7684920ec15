// SPDX-License-Identifier: Apache-2.0
#include "link/link_archive.h"

#include <cmath>

namespace condyle::hal {

void LinkWriter::write(std::uint64_t bits, std::size_t size) {
  ok_ = ok_ && bytes_.size() - size_ >= size;
  if (!ok_) return;
  for (std::size_t i = 0; i < size; ++i) {
    bytes_[size_++] = static_cast<std::uint8_t>(bits >> 8 * i & 0xFFU);
  }
}

void LinkWriter::text(const FixedText& value) {
  for (const char character : value) store(static_cast<std::uint8_t>(character));
}

void LinkWriter::events(const EventSet& events) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < kEventCount; ++i) {
    bits |= std::uint32_t{events.has(static_cast<Event>(i))} << i;
  }
  store(bits);
}

void LinkWriter::rest(const std::span<const std::uint8_t>& bytes, std::size_t most) {
  ok_ = ok_ && bytes.size() <= most;
  for (const std::uint8_t byte : bytes) store(byte);
}

void LinkReader::begin_value() {
  index_ = next_index_;
  ++next_index_;
}

std::uint64_t LinkReader::read(std::size_t size) {
  begin_value();
  require(rest_.size() >= size, RefusalReason::wrong_size);
  if (!ok()) return 0;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i) bits |= std::uint64_t{rest_[i]} << 8 * i;
  rest_ = rest_.subspan(size);
  return bits;
}

void LinkReader::finite(double& value) {
  number(value);
  require(std::isfinite(value), RefusalReason::not_finite);
}

void LinkReader::within(double& value, Range range) {
  finite(value);
  require(range.contains(value), RefusalReason::out_of_range);
}

void LinkReader::text(FixedText& value) {
  for (char& character : value) character = static_cast<char>(load<std::uint8_t>());
  require(is_plain(value), RefusalReason::unknown_value);
}

void LinkReader::message_type(MessageType& value) {
  const auto read = load<std::uint8_t>();
  require(is_message_type(read), RefusalReason::unknown_value);
  value = static_cast<MessageType>(read);
}

void LinkReader::events(EventSet& events) {
  const auto bits = load<std::uint32_t>();
  require(bits >> kEventCount == 0, RefusalReason::unknown_value);
  events = {};
  for (std::size_t i = 0; i < kEventCount; ++i) {
    events.add(static_cast<Event>(i), (bits >> i & 1U) != 0);
  }
}

void LinkReader::rest(std::span<const std::uint8_t>& bytes, std::size_t most) {
  begin_value();
  require(rest_.size() <= most, RefusalReason::wrong_size);
  bytes = std::exchange(rest_, {});
}

Refusal LinkReader::finish() {
  begin_value();
  require(rest_.empty(), RefusalReason::wrong_size);
  return refusal_;
}

}  // namespace condyle::hal
