// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace condyle::hal {

/// Up to `kMost` values in a row, without heap.
template <class Value, std::size_t kMost>
class FixedList {
 public:
  /// Appends `value`; false if there is no room for it.
  constexpr bool push_back(const Value& value) {
    if (size_ == kMost) return false;
    values_[size_++] = value;
    return true;
  }
  /// Removes the last value; there must be one.
  constexpr void pop_back() { --size_; }
  constexpr void clear() { size_ = 0; }

  constexpr std::size_t size() const { return size_; }
  constexpr bool empty() const { return size_ == 0; }
  static constexpr std::size_t capacity() { return kMost; }

  /// Value `index`, which must be below size().
  constexpr Value& operator[](std::size_t index) { return values_[index]; }
  constexpr const Value& operator[](std::size_t index) const { return values_[index]; }
  constexpr Value* begin() { return values_.data(); }
  constexpr Value* end() { return values_.data() + size_; }
  constexpr const Value* begin() const { return values_.data(); }
  constexpr const Value* end() const { return values_.data() + size_; }

 private:
  std::array<Value, kMost> values_{};
  std::size_t size_ = 0;
};

}  // namespace condyle::hal
