// SPDX-License-Identifier: Apache-2.0
#include "statistics/monte_carlo.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <vector>

#include "statistics/in_blocks.h"

namespace condyle::host {
namespace {

using Seeds = std::vector<std::uint64_t>;

// Later runs overtake earlier ones.
std::uint64_t work_of_varying_length(std::uint64_t seed) {
  std::this_thread::sleep_for(std::chrono::microseconds(seed * 7919 % 300));
  return seed;
}

TEST(MonteCarlo, MergesInTheOrderOfTheSeeds) {
  for (const unsigned threads : {0U, 1U, 2U, 5U, 64U}) {
    Seeds merged, told;
    const auto count = run_monte_carlo(
        100, 1000, work_of_varying_length, [&](std::uint64_t seed) { merged.push_back(seed); },
        [&](std::uint64_t done, std::uint64_t runs) {
          EXPECT_EQ(runs, 100U);
          told.push_back(done);
        },
        {.threads = threads});
    EXPECT_EQ(count, 100U);
    ASSERT_EQ(merged.size(), 100U);
    ASSERT_EQ(told.size(), 100U);
    for (std::uint64_t i = 0; i < 100; ++i) {
      EXPECT_EQ(merged[i], 1000 + i);
      EXPECT_EQ(told[i], i + 1);
    }
  }
}

TEST(MonteCarlo, NoRunsAreNoWork) {
  EXPECT_EQ(run_monte_carlo(0, 1, work_of_varying_length, [](std::uint64_t) { FAIL(); }), 0U);
}

TEST(MonteCarlo, ThrowsOnTheFirstFailureInTheOrderOfTheSeeds) {
  for (const unsigned threads : {1U, 2U, 5U}) {
    Seeds merged;
    const auto work = [](std::uint64_t seed) {
      if (seed == 7) std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (seed >= 7) throw std::runtime_error("seed " + std::to_string(seed));
      return seed;
    };
    try {
      run_monte_carlo(1000, 0, work, [&](std::uint64_t seed) { merged.push_back(seed); }, {},
                      {.threads = threads});
      FAIL() << "no exception";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "seed 7");
    }
    EXPECT_EQ(merged, (Seeds{0, 1, 2, 3, 4, 5, 6}));
  }
}

TEST(MonteCarlo, ThrowsOnWhatMergingThrows) {
  const auto merge = [](std::uint64_t seed) {
    if (seed == 3) throw std::logic_error("merge");
  };
  EXPECT_THROW(run_monte_carlo(1000, 0, work_of_varying_length, merge, {}, {.threads = 5}),
               std::logic_error);
}

TEST(MonteCarlo, StopsAtTheSameRunForEveryNumberOfThreads) {
  for (const unsigned threads : {1U, 2U, 5U}) {
    std::uint64_t sum = 0;
    std::atomic<std::uint64_t> started = 0;
    const auto work = [&](std::uint64_t seed) {
      ++started;
      return work_of_varying_length(seed);
    };
    const auto merged =
        run_monte_carlo(1000000, 1, work, [&](std::uint64_t seed) { sum += seed; }, {},
                        {.threads = threads, .stop = [&] { return sum >= 55; }});
    EXPECT_EQ(merged, 10U);
    EXPECT_EQ(sum, 55U);
    EXPECT_LE(started, 10 + 2 * threads);
  }
}

TEST(MonteCarlo, SaysThatItWaits) {
  std::atomic<int> waits = 0;
  const auto work = [&](std::uint64_t) {
    while (waits < 3) std::this_thread::yield();
    return 0;
  };
  const auto caller = std::this_thread::get_id();
  run_monte_carlo(1, 1, work, [](int) {}, {}, {.while_waiting = [&] {
                    EXPECT_EQ(std::this_thread::get_id(), caller);
                    ++waits;
                  }});
  EXPECT_GE(waits, 3);
}

TEST(MonteCarlo, HoldsFewResultsWhenMergingIsSlow) {
  static std::atomic<int> alive = 0, most_alive = 0;
  struct Result {
    Result() {
      const int now = ++alive;
      int most = most_alive;
      while (now > most && !most_alive.compare_exchange_weak(most, now)) {
      }
    }
    Result(Result&&) noexcept { ++alive; }
    Result& operator=(Result&&) = default;
    ~Result() { --alive; }
  };
  run_monte_carlo(
      60, 0, [](std::uint64_t) { return Result(); },
      [](Result&&) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }, {},
      {.threads = 3});
  EXPECT_EQ(alive, 0);
  EXPECT_LE(most_alive, 2 * 3 + 3 + 2);  // places, those being moved in, and the one being merged
}

TEST(InBlocks, CoversEachItemOnce) {
  for (const std::size_t count : {0U, 1U, 7U, 8U, 9U, 800U}) {
    std::vector<int> visits(count, 0);
    run_in_blocks(count, 8, [&](std::size_t begin, std::size_t end) {
      EXPECT_LE(end - begin, 8U);
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    EXPECT_EQ(visits, std::vector<int>(count, 1));
  }
}

TEST(InBlocks, RethrowsTheFirstException) {
  const auto work = [](std::size_t begin, std::size_t) {
    if (begin >= 16) throw std::runtime_error(std::to_string(begin));
  };
  try {
    run_in_blocks(100, 8, work);
    FAIL() << "it threw nothing";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "16");
  }
}

}  // namespace
}  // namespace condyle::host
