// SPDX-License-Identifier: Apache-2.0
// The reading thread allocates nothing: neither where a report is recorded, a ring is full or an
// event is told, nor where it is replayed. A session's files share the memory of the first.
#include <gtest/gtest.h>

#include <string>

#include "condyle/hal/facebow.h"
#include "condyle/hal/log/session_log_source.h"
#include "support/allocation_counter.h"
#include "support/session.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing_support::allocation_count;

TEST(SessionAllocation, RecordingAndReplayingAReportNeedsNone) {
  if (MALLOC_IS_TAKEN) GTEST_SKIP() << "the sanitizer replaces malloc itself";
  const testing_support::TemporaryFolder folder;
  const std::string path = folder / "log.mcap";
  const hal::RawReport report = testing_support::make_report(1, 29, 2);
  std::uint64_t accepted = 0;
  {
    hal::SessionLogWriter log({.ring_reports = 500});
    ASSERT_EQ(log.open(path, testing_support::make_header()), hal::SessionLogFailure::none);
    const long before = allocation_count();
    for (int i = 0; i < 2'000; ++i) {
      accepted += log.write(0, report) ? 1U : 0U;
      if (i % 100 == 0) {
        static_cast<void>(log.write_event(0, 2, hal::SessionEvent::stall, "endpoint 0x81"));
      }
    }
    while (log.write(0, report)) ++accepted;  // until it is full
    EXPECT_EQ(allocation_count(), before);
    EXPECT_GT(log.status().reports_lost, 0U);
  }
  hal::SessionLogSource source(path);
  hal::RawReport read;
  ASSERT_EQ(source.open(), hal::Status::ok);
  // The first chunk also tells what the channels are called.
  ASSERT_EQ(source.read(hal::kNoDeadline, read), hal::Status::ok);
  const long before = allocation_count();
  std::uint64_t replayed = 1;
  while (source.read(hal::kNoDeadline, read) == hal::Status::ok) ++replayed;
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(replayed, accepted);
  EXPECT_EQ(source.condition().outcome, hal::McapRead::end);
}

// As the box does: two writers take turns, and both are open for a moment.
TEST(SessionAllocation, AllFilesOfASessionTakeTheMemoryOfItsStart) {
  if (MALLOC_IS_TAKEN) GTEST_SKIP() << "the sanitizer replaces malloc itself";
  const testing_support::TemporaryFolder folder;
  constexpr int kParts = 6;
  constexpr std::uint32_t kReports = 1'000;  // a dozen full chunks and the rest
  const hal::SessionLogOptions options{.chunk_time_ns = 3'600 * kNanosecondsPerSecond};
  hal::SessionLogWriter logs[] = {hal::SessionLogWriter(options), hal::SessionLogWriter(options)};
  const hal::SessionHeader header = testing_support::make_header(3);
  const auto path = [&](int part) { return folder / (std::to_string(part) + ".mcap"); };
  const long at_first = testing_support::large_allocation_count();
  for (hal::SessionLogWriter& log : logs) {
    ASSERT_EQ(log.prepare(header), hal::SessionLogFailure::none);
  }
  const long before = testing_support::large_allocation_count();
  EXPECT_GE(before - at_first, 2 * 4);  // the rings, and at least one buffer
  ASSERT_EQ(logs[0].open(path(0), header), hal::SessionLogFailure::none);
  for (int part = 0; part < kParts; ++part) {
    hal::SessionLogWriter& log = logs[part % 2];
    for (std::uint32_t i = 0; i < kReports; ++i) {
      ASSERT_TRUE(log.write(i % 3, testing_support::make_report(i, 800, i)));
    }
    ASSERT_EQ(logs[(part + 1) % 2].open(path(part + 1), header), hal::SessionLogFailure::none);
    ASSERT_EQ(log.close(), hal::SessionLogFailure::none);
    EXPECT_EQ(log.status().reports_written, kReports);
    EXPECT_GT(log.status().chunks_written, 10U);
  }
  ASSERT_EQ(logs[kParts % 2].close(), hal::SessionLogFailure::none);
  EXPECT_EQ(testing_support::large_allocation_count(), before);
  for (int part = 0; part < kParts; ++part) {
    hal::SessionLogSource source(path(part), 1);
    hal::RawReport report;
    ASSERT_EQ(source.open(), hal::Status::ok);
    std::uint32_t number = 1;
    for (; source.read(hal::kNoDeadline, report) == hal::Status::ok; number += 3) {
      ASSERT_TRUE(
          testing_support::is_same(report, testing_support::make_report(number, 800, number)));
    }
    EXPECT_EQ(number, kReports);
    EXPECT_EQ(source.condition().outcome, hal::McapRead::end);
  }
}

}  // namespace
}  // namespace condyle
