// SPDX-License-Identifier: Apache-2.0
// Writer, reader and locator of messages have the same functions, so that one list of a message's
// values serves all. Longer functions are in link_archive.cpp, once, because memory is short on a
// target. Library-private.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "condyle/hal/fixed_list.h"
#include "condyle/hal/link/link_messages.h"

namespace condyle::hal {

template <class Number>
using BitsOf = std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint64_t>;

/// Writes values one after the other.
class LinkWriter {
 public:
  static constexpr bool kWrites = true;

  explicit LinkWriter(std::span<std::uint8_t> bytes) : bytes_(bytes) {}

  /// Writes `value` as a `Wire`; refuses a value that this cannot hold.
  template <class Wire, class Value>
  void integer(const Value& value) {
    ok_ = ok_ && std::in_range<Wire>(value);
    store(static_cast<std::make_unsigned_t<Wire>>(value));
  }
  void boolean(const bool& value) { store(std::uint8_t{value}); }
  template <class Enumeration>
  void enumeration(const Enumeration& value, Enumeration /*highest*/) {
    store(static_cast<std::uint8_t>(value));
  }
  template <class Number>
  void number(const Number& value) {
    store(std::bit_cast<BitsOf<Number>>(value));
  }
  void finite(const double& value) { number(value); }
  void text(const FixedText& value);
  void message_type(const MessageType& value) { store(static_cast<std::uint8_t>(value)); }
  void events(const EventSet& events);
  void within(const double& value, Range) { number(value); }
  template <class Value, class Exchange>
  void optional(const std::optional<Value>& value, Exchange exchange) {
    boolean(value.has_value());
    if (value) exchange(*value);
  }
  template <class Value, std::size_t kMost, class Exchange>
  void list(const FixedList<Value, kMost>& values, Exchange exchange) {
    static_assert(kMost <= 255);
    integer<std::uint8_t>(values.size());
    for (const Value& value : values) exchange(value);
  }
  void rest(const std::span<const std::uint8_t>& bytes, std::size_t most);
  /// Conditions are checked only when a message is read.
  void require(bool, RefusalReason) {}
  bool ok() const { return ok_; }

  /// Bytes written; none if something did not fit.
  std::optional<std::size_t> finish() const {
    if (!ok_) return {};
    return size_;
  }

 private:
  template <class Bits>
  void store(Bits bits) {
    write(bits, sizeof bits);
  }
  void write(std::uint64_t bits, std::size_t size);

  std::span<std::uint8_t> bytes_;
  std::size_t size_ = 0;
  bool ok_ = true;
};

/// Reads values one after the other. From the first refused value on, all read as zero.
class LinkReader {
 public:
  static constexpr bool kWrites = false;

  explicit LinkReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  template <class Wire, class Value>
  void integer(Value& value) {
    const auto read = static_cast<Wire>(load<std::make_unsigned_t<Wire>>());
    require(std::in_range<Value>(read), RefusalReason::out_of_range);
    value = static_cast<Value>(read);
  }
  void boolean(bool& value) {
    const auto read = load<std::uint8_t>();
    require(read <= 1, RefusalReason::unknown_value);
    value = read == 1;
  }
  /// An enumerator up to `highest`.
  template <class Enumeration>
  void enumeration(Enumeration& value, Enumeration highest) {
    const auto read = load<std::uint8_t>();
    require(read <= static_cast<std::uint8_t>(highest), RefusalReason::unknown_value);
    value = static_cast<Enumeration>(ok() ? read : 0);
  }
  /// Any value, NaN included.
  template <class Number>
  void number(Number& value) {
    value = std::bit_cast<Number>(load<BitsOf<Number>>());
  }
  void finite(double& value);
  void text(FixedText& value);
  void message_type(MessageType& value);
  void events(EventSet& events);
  void within(double& value, Range range);
  template <class Value, class Exchange>
  void optional(std::optional<Value>& value, Exchange exchange) {
    bool has_value = false;
    boolean(has_value);
    value.reset();
    if (has_value && ok()) exchange(value.emplace());
  }
  template <class Value, std::size_t kMost, class Exchange>
  void list(FixedList<Value, kMost>& values, Exchange exchange) {
    std::size_t count = 0;
    integer<std::uint8_t>(count);
    require(count <= kMost, RefusalReason::out_of_range);
    values.clear();
    for (std::size_t i = 0; ok() && i < count; ++i) {
      Value value;
      exchange(value);
      values.push_back(value);
    }
  }
  /// All remaining bytes, at most `most`.
  void rest(std::span<const std::uint8_t>& bytes, std::size_t most);
  /// Refuses the last value unless `condition` holds.
  void require(bool condition, RefusalReason reason) {
    if (ok() && !condition) refusal_ = {reason, index_};
  }

  bool ok() const { return refusal_.reason == RefusalReason::none; }

  /// Refuses the message if bytes remain.
  Refusal finish();

 private:
  template <class Bits>
  Bits load() {
    return static_cast<Bits>(read(sizeof(Bits)));
  }
  std::uint64_t read(std::size_t size);
  void begin_value();

  std::span<const std::uint8_t> rest_;
  std::uint16_t index_ = 0, next_index_ = 0;
  Refusal refusal_;
};

/// `Value`, const for functions that do not change it.
template <class Archive, class Value>
using Exchanged = std::conditional_t<Archive::kWrites, const Value, Value>;

}  // namespace condyle::hal
