// SPDX-License-Identifier: Apache-2.0
#include "box/realtime/real_time.h"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

namespace condyle::box {
namespace {

constexpr std::size_t kStackBytes = 1024 * 1024;

[[gnu::noinline]] void touch_stack() {
  char pages[kStackBytes];
  std::memset(pages, 0, sizeof pages);
  asm volatile("" : : "r"(pages) : "memory");  // so that it is not left out
}

}  // namespace

std::string become_real_time(int priority) {
  touch_stack();
  if (priority == 0) return "SCHED_OTHER, as configured";
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (error == 0) return "SCHED_FIFO " + std::to_string(priority);
  return std::string("SCHED_OTHER: SCHED_FIFO was refused, ") + std::strerror(error);
}

std::string lock_memory() {
  // With a limit, later threads would have no memory for their stacks.
  rlimit limit{};
  const bool may_lock_all =
      geteuid() == 0 || (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY);
  if (!may_lock_all) return "not locked: RLIMIT_MEMLOCK is not unlimited";
  (void)mallopt(M_TRIM_THRESHOLD, -1);
  (void)mallopt(M_MMAP_MAX, 0);
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    return std::string("not locked: ") + std::strerror(errno);
  }
  // Later pages when they are first used: of 8 MB for a thread's stack, few ever are. A kernel that
  // cannot do so has locked them whole.
  (void)mlockall(MCL_FUTURE | MCL_ONFAULT);
  return "locked";
}

}  // namespace condyle::box
