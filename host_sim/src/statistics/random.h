// SPDX-License-Identifier: Apache-2.0
// Random numbers that are identical on all machines.
//
// Generator: Philox4x32-10 (Salmon, Moraes, Dror, Shaw 2011, "Parallel random numbers: as easy as
// 1, 2, 3", SC11). It enciphers a counter of 128 bits under a key of 64 bits. The key is the seed;
// the upper half of the counter is the stream, the lower half counts blocks of two numbers. So two
// streams of a seed never share a block; a stream repeats after 2^65 numbers.
// Normal numbers: the polar method (Marsaglia, Bray 1964), exact up to the 53 bits of `uniform`,
// with the logarithm of elementary.h.
#pragma once

#include <array>
#include <cstdint>

namespace condyle::host {

/// One block of Philox4x32-10. Words are 32-bit, the lowest first.
std::array<std::uint32_t, 4> philox_block(std::array<std::uint32_t, 4> counter,
                                          std::array<std::uint32_t, 2> key);

/// Numbers of one stream under one seed. A uniform random bit generator of the standard library.
class RandomGenerator {
 public:
  using result_type = std::uint64_t;
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~result_type{0}; }
  result_type operator()() { return next(); }

  explicit RandomGenerator(std::uint64_t seed, std::uint64_t stream = 0)
      : seed_(seed), stream_(stream) {}

  /// All 64-bit numbers, equally likely.
  std::uint64_t next();
  /// Multiples of 2^-53 in [0, 1), equally likely.
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }
  /// Normal, mean 0 and standard deviation 1. Draws a varying number of uniform numbers.
  double normal();

 private:
  std::uint64_t seed_, stream_;
  std::uint64_t block_ = 0;   // the next one to encipher
  std::uint64_t second_ = 0;  // of the last block
  bool has_second_ = false;
  double second_normal_ = 0;
  bool has_second_normal_ = false;
};

}  // namespace condyle::host
