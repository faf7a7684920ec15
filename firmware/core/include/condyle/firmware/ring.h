// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <type_traits>

namespace condyle::firmware {

/// Passes values from one thread to one other, in order. Neither ever waits; if the ring is full,
/// values are dropped and counted. No heap; `kCapacity` is a power of two. Counts have the size
/// that every machine reads in one piece; they may wrap.
template <class Value, std::size_t kCapacity>
class Ring {
  static_assert(kCapacity > 0 && (kCapacity & (kCapacity - 1)) == 0);
  // A value that owned memory would have to free it.
  static_assert(std::is_trivially_destructible_v<Value>);

 public:
  /// For the writer: false if there is no room for `value`.
  bool push(const Value& value) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == kCapacity) {
      dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return false;
    }
    values_[end % kCapacity] = value;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }
  /// For the reader: false if it is empty.
  bool pop(Value& value) {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    value = values_[begin % kCapacity];
    begin_.store(begin + 1, std::memory_order_release);
    return true;
  }

  /// True if the reader has nothing to take; for the reader.
  bool empty() const {
    return begin_.load(std::memory_order_relaxed) == end_.load(std::memory_order_acquire);
  }

  /// Values dropped for want of room; any thread may ask.
  std::size_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kCacheLine = 64;  // so that the threads do not share one

  alignas(kCacheLine) std::atomic<std::size_t> end_ = 0;
  std::atomic<std::size_t> dropped_ = 0;
  alignas(kCacheLine) std::atomic<std::size_t> begin_ = 0;
  alignas(kCacheLine) std::array<Value, kCapacity> values_{};
};

}  // namespace condyle::firmware
