// SPDX-License-Identifier: Apache-2.0
// Replaces malloc and related functions in the program whose one source includes this: they count
// the calls of each thread, and the large blocks of all. operator new calls them.
#pragma once

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#include "support/sanitizer.h"

#if CONDYLE_UNDER_SANITIZER
#define MALLOC_IS_TAKEN 1
#else
#define MALLOC_IS_TAKEN 0
namespace {
thread_local long allocations = 0;
std::atomic<long> large_allocations = 0;

void count(std::size_t bytes) {
  ++allocations;
  if (bytes >= (std::size_t{16} << 10)) ++large_allocations;
}
}  // namespace
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* __libc_calloc(std::size_t count, std::size_t size);
extern "C" void* __libc_realloc(void* block, std::size_t size);
extern "C" void* __libc_memalign(std::size_t alignment, std::size_t size);
extern "C" void* malloc(std::size_t size) {
  count(size);
  return __libc_malloc(size);
}
extern "C" void* calloc(std::size_t blocks, std::size_t size) {
  count(blocks * size);
  return __libc_calloc(blocks, size);
}
extern "C" void* realloc(void* block, std::size_t size) {
  count(size);
  return __libc_realloc(block, size);
}
extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count(size);
  return __libc_memalign(alignment, size);
}
extern "C" int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  count(size);
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
#endif

namespace condyle::testing_support {

/// Calls of malloc and related functions by this thread so far; always 0 if MALLOC_IS_TAKEN.
inline long allocation_count() {
#if MALLOC_IS_TAKEN
  return 0;
#else
  return allocations;
#endif
}

/// Blocks of 16 KiB or more that all threads have asked for; always 0 if MALLOC_IS_TAKEN.
inline long large_allocation_count() {
#if MALLOC_IS_TAKEN
  return 0;
#else
  return large_allocations;
#endif
}

}  // namespace condyle::testing_support
