// SPDX-License-Identifier: Apache-2.0
// The reading thread allocates nothing: neither where a report is recorded, a ring is full or an
// event is told, nor where it is replayed.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace condyle
