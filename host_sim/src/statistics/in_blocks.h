// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "statistics/monte_carlo.h"

namespace condyle::host {

/// Of a recording, whose fits would take hundreds of bytes for each of its samples.
inline constexpr std::size_t kSamplesInBlock = 4096;

/// Runs `work(begin, end)` for each block of at most `size` of `count` items, on all cores. Where
/// each block writes only to items of its own, the outcome is the same for every number of threads.
/// An exception of `work` is rethrown: that of the first block that has one.
template <class Work>
void run_in_blocks(std::size_t count, std::size_t size, const Work& work) {
  struct Done {};
  run_monte_carlo((count + size - 1) / size, 0,
                  [&](std::uint64_t index) {
                    const std::size_t begin = static_cast<std::size_t>(index) * size;
                    work(begin, std::min(begin + size, count));
                    return Done{};
                  },
                  [](Done) {});
}

}  // namespace condyle::host
