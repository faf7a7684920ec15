// SPDX-License-Identifier: Apache-2.0
// The files of a session take the memory and the descriptors of its start.
#include <gtest/gtest.h>
#include <malloc.h>

#include <filesystem>
#include <iterator>

#include "box/running_box.h"
#include "support/allocation_counter.h"

namespace condyle {
namespace {

using testing_support::post;
using testing_support::RunningBox;
using testing_support::wait_for;

TEST(SessionMemory, OfASessionServesAllItsFiles) {
  if (MALLOC_IS_TAKEN) GTEST_SKIP() << "the sanitizer replaces malloc itself";
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  ASSERT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
  long before = 0;
  for (int part = 1; part <= 6; ++part) {
    ASSERT_TRUE(wait_for([&] {
      const box::SessionState session = running.box->status().session;
      return session.part == part && session.log.reports_written > 0;
    }));
    if (part == 2) before = testing_support::large_allocation_count();
    // A deleted file is followed by another.
    if (part < 6) std::filesystem::remove(running.box->status().session.file);
  }
  EXPECT_EQ(testing_support::large_allocation_count(), before);
  EXPECT_GT(before, 0);
  EXPECT_EQ(post(running.port, "/v1/session/stop", "{}").status, 200);
  const box::SessionState session = running.box->status().session;
  EXPECT_EQ(session.part, 6);
  EXPECT_EQ(session.reports_received, session.reports_written + session.reports_lost);
}

}  // namespace
}  // namespace condyle
