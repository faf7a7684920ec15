// SPDX-License-Identifier: Apache-2.0
#include "box/realtime/real_time.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <latch>
#include <thread>

#include "support/resident_memory.h"
#include "support/sanitizer.h"

namespace condyle::box {
namespace {

using testing_support::resident_MB;

enum Outcome { small, large, not_locked };

// In locked memory, what four threads take that are alive at once. Each has a stack of 8 MB.
Outcome take_four_threads() {
  if (lock_memory() != "locked") return not_locked;
  const double before_MB = resident_MB();
  std::latch are_alive(4), may_end(1);
  std::array<std::thread, 4> threads;
  for (std::thread& thread : threads) {
    thread = std::thread([&] {
      are_alive.count_down();
      may_end.wait();
    });
  }
  are_alive.wait();
  const double taken_MB = resident_MB() - before_MB;
  may_end.count_down();
  for (std::thread& thread : threads) thread.join();
  return taken_MB < 4 ? small : large;
}

TEST(LockedMemory, HoldsOfAThreadsStackWhatItUses) {
  // Its mlockall locks nothing, and says that it did.
  if (CONDYLE_UNDER_SANITIZER) GTEST_SKIP() << "a sanitizer locks no memory";
  const pid_t child = fork();  // the lock ends with it
  ASSERT_GE(child, 0);
  if (child == 0) std::_Exit(take_four_threads());
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == not_locked) GTEST_SKIP() << "may not lock its memory";
  EXPECT_EQ(WEXITSTATUS(status), small);
}

}  // namespace
}  // namespace condyle::box
