// SPDX-License-Identifier: Apache-2.0
#include "statistics/random.h"

#include <cmath>

#include "condyle/estimator/math/elementary.h"

namespace condyle::host {

namespace {

constexpr std::uint32_t low_word(std::uint64_t x) {
  return static_cast<std::uint32_t>(x);
}
constexpr std::uint32_t high_word(std::uint64_t x) {
  return static_cast<std::uint32_t>(x >> 32U);
}
constexpr std::uint64_t join(std::uint32_t low, std::uint32_t high) {
  return std::uint64_t{high} << 32U | low;
}

}  // namespace

std::array<std::uint32_t, 4> philox_block(std::array<std::uint32_t, 4> counter,
                                          std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xd2511f53U} * counter[0];
    const std::uint64_t b = std::uint64_t{0xcd9e8d57U} * counter[2];
    counter = {high_word(b) ^ counter[1] ^ key[0], low_word(b), high_word(a) ^ counter[3] ^ key[1],
               low_word(a)};
    key[0] += 0x9e3779b9U;
    key[1] += 0xbb67ae85U;
  }
  return counter;
}

std::uint64_t RandomGenerator::next() {
  if (has_second_) {
    has_second_ = false;
    return second_;
  }
  const auto words =
      philox_block({low_word(block_), high_word(block_), low_word(stream_), high_word(stream_)},
                   {low_word(seed_), high_word(seed_)});
  ++block_;
  second_ = join(words[2], words[3]);
  has_second_ = true;
  return join(words[0], words[1]);
}

double RandomGenerator::normal() {
  if (has_second_normal_) {
    has_second_normal_ = false;
    return second_normal_;
  }
  for (;;) {
    const double x = 2 * uniform() - 1;
    const double y = 2 * uniform() - 1;
    const double square = x * x + y * y;
    if (square >= 1 || square == 0) continue;
    const double factor = std::sqrt(-2 * elementary::log(square) / square);
    second_normal_ = y * factor;
    has_second_normal_ = true;
    return x * factor;
  }
}

}  // namespace condyle::host
