// SPDX-License-Identifier: Apache-2.0
// The files of a session take the memory and the descriptors of its start.
#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>

#include "box/running_box.h"
#include "support/allocation_counter.h"

namespace condyle {
namespace {

using testing_support::post;
using testing_support::RunningBox;
using testing_support::wait_for;

std::ptrdiff_t open_descriptors() {
  const std::filesystem::directory_iterator begin("/proc/self/fd"), end;
  return std::distance(begin, end);
}

TEST(SessionMemory, OfASessionServesAllItsFiles) {
  if (MALLOC_IS_TAKEN) GTEST_SKIP() << "the sanitizer replaces malloc itself";
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  ASSERT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
  long blocks = 0;
  std::ptrdiff_t descriptors = 0;
  for (int part = 1; part <= 6; ++part) {
    ASSERT_TRUE(wait_for([&] {
      const box::SessionState session = running.box->status().session;
      return session.part == part && session.log.reports_written > 0;
    }));
    if (part == 2) {
      descriptors = open_descriptors();  // takes memory itself
      blocks = testing_support::large_allocation_count();
    }
    // A deleted file is followed by another.
    if (part < 6) std::filesystem::remove(running.box->status().session.file);
  }
  EXPECT_GT(blocks, 0);
  EXPECT_EQ(testing_support::large_allocation_count(), blocks);
  EXPECT_LE(open_descriptors(), descriptors);
  EXPECT_EQ(post(running.port, "/v1/session/stop", "{}").status, 200);
  const box::SessionState session = running.box->status().session;
  EXPECT_EQ(session.part, 6);
  EXPECT_EQ(session.reports_received, session.reports_written + session.reports_lost);
}

}  // namespace
}  // namespace condyle
