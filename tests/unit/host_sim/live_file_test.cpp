// SPDX-License-Identifier: Apache-2.0
// What is written live reaches a slow disk whole; only a reader that stalls is abandoned.
#include "output/live_file.h"

#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <vector>

namespace condyle::host {
namespace {

std::atomic<bool> is_interrupted = false;  // set by the signal that ends a write

// Holds the rows of a file. It can stall at each row, or when the file is closed. A stall ends when
// `is_released` or `is_interrupted` is set.
struct Medium {
  std::atomic<bool> has_reader = false, stalls_at_row = false, stalls_at_close = false;
  std::atomic<bool> is_released = false, is_committed = false;
  std::vector<int> rows;  // of the writing thread

  void stall_if(bool stalls) const {
    while (stalls && !is_released && !is_interrupted)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
};

class StallingFile {
 public:
  using Row = int;
  explicit StallingFile(Medium& medium) : medium_(medium) {}
  bool has_reader() const { return medium_.has_reader; }
  void write_row(int row) {
    medium_.stall_if(medium_.stalls_at_row);
    medium_.rows.push_back(row);
  }
  void close() { medium_.stall_if(medium_.stalls_at_close); }
  void commit() { medium_.is_committed = true; }

 private:
  Medium& medium_;
};

constexpr int kRows = 50;

// Releases the medium once `finish` has waited for so long.
std::uint64_t finish_and_release(Medium& medium, std::chrono::milliseconds after) {
  LiveFile<StallingFile> file(medium);
  for (int row = 0; row < kRows; ++row) file.add(row);
  std::thread release([&] {
    std::this_thread::sleep_for(after);
    medium.is_released = true;
  });
  file.finish();
  release.join();
  return file.dropped();
}

TEST(LiveFile, WaitsForADiskThatIsSlowAtTheLastRows) {
  Medium medium;
  medium.stalls_at_row = true;
  EXPECT_EQ(finish_and_release(medium, std::chrono::milliseconds(2500)), 0U);
  EXPECT_EQ(medium.rows.size(), std::size_t{kRows});
  EXPECT_TRUE(medium.is_committed);
}

TEST(LiveFile, WaitsForADiskThatIsSlowAtTheEnd) {
  Medium medium;
  medium.stalls_at_close = true;
  EXPECT_EQ(finish_and_release(medium, std::chrono::milliseconds(2500)), 0U);
  EXPECT_TRUE(medium.is_committed);
}

// Its rows are counted.
TEST(LiveFile, AbandonsAReaderThatStalls) {
  Medium medium;
  medium.has_reader = medium.stalls_at_row = true;
  const auto usual = std::signal(SIGTERM, SIG_DFL);
  prepare_program([](int) { is_interrupted = true; });
  {
    LiveFile<StallingFile> file(medium);
    for (int row = 0; row < kRows; ++row) file.add(row);
    file.finish();
    EXPECT_TRUE(is_interrupted);
    EXPECT_EQ(file.dropped() + medium.rows.size(), std::uint64_t{kRows});
    EXPECT_LE(medium.rows.size(), 1U) << "the row that it was given";
  }
  for (const int number : {SIGINT, SIGTERM}) std::signal(number, usual);
  is_interrupted = false;
}

}  // namespace
}  // namespace condyle::host
