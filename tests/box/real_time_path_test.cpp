// SPDX-License-Identifier: Apache-2.0
// From a report in hand to its estimate in the ring the real-time thread takes no memory, no lock
// and makes no call that may block: those of the C library are replaced in this program by ones
// that count.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <memory>
#include <mutex>

#include "box/realtime/engine.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/devices/synthetic_source.h"
#include "support/allocation_counter.h"
#include "support/paths.h"
#include "support/session.h"
#include "support/temporary_folder.h"

namespace {

thread_local long blocking_calls = 0;

template <class Function>
Function real(Function, const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

#if !MALLOC_IS_TAKEN
#define COUNTED(type, name, parameters, arguments)   \
  extern "C" type name parameters {                  \
    static const auto original = real(&name, #name); \
    ++blocking_calls;                                \
    return original arguments;                       \
  }
COUNTED(int, pthread_mutex_lock, (pthread_mutex_t * mutex), (mutex))
COUNTED(int, pthread_cond_wait, (pthread_cond_t * condition, pthread_mutex_t* mutex),
        (condition, mutex))
COUNTED(int, pthread_rwlock_rdlock, (pthread_rwlock_t * lock), (lock))
COUNTED(int, pthread_rwlock_wrlock, (pthread_rwlock_t * lock), (lock))
COUNTED(ssize_t, read, (int file, void* bytes, std::size_t size), (file, bytes, size))
COUNTED(ssize_t, write, (int file, const void* bytes, std::size_t size), (file, bytes, size))
COUNTED(ssize_t, writev, (int file, const iovec* parts, int count), (file, parts, count))
COUNTED(ssize_t, send, (int file, const void* bytes, std::size_t size, int flags),
        (file, bytes, size, flags))
COUNTED(ssize_t, recv, (int file, void* bytes, std::size_t size, int flags),
        (file, bytes, size, flags))
COUNTED(int, poll, (pollfd * files, nfds_t count, int timeout_ms), (files, count, timeout_ms))
COUNTED(int, nanosleep, (const timespec* wanted, timespec* left), (wanted, left))
COUNTED(int, clock_nanosleep, (clockid_t clock, int flags, const timespec* wanted, timespec* left),
        (clock, flags, wanted, left))
#undef COUNTED
#endif

namespace condyle::box {
namespace {

// What the thread did between a report's arrival and asking for the next, in the same run.
class ProbedSource final : public hal::ReportSource {
 public:
  ProbedSource(double rate_Hz, hal::Clock& clock) : source_(rate_Hz, clock) {}

  hal::Status open() override { return source_.open(); }
  void close() override { source_.close(); }
  hal::TransportCounts counts() const override { return {}; }
  hal::Status read(TimeNs deadline_ns, hal::RawReport& report) override {
    if (has_report_ && engine->run() == run_) {
      allocations += testing_support::allocation_count() - allocations_before_;
      calls += blocking_calls - calls_before_;
    }
    const hal::Status status = source_.read(deadline_ns, report);
    has_report_ = status == hal::Status::ok;
    if (has_report_) ++reports;
    run_ = engine->run();
    allocations_before_ = testing_support::allocation_count();
    calls_before_ = blocking_calls;
    return status;
  }

  std::atomic<long> reports = 0, allocations = 0, calls = 0;
  const Engine* engine = nullptr;

 private:
  host::SyntheticSource source_;
  std::uint64_t run_ = 0;
  bool has_report_ = false;
  long allocations_before_ = 0, calls_before_ = 0;
};

constexpr double kRate_Hz = 50'000;  // or as many as this machine takes

void wait_for_reports(const ProbedSource& source, long count) {
  hal::SteadyClock clock;
  while (source.reports < count) clock.sleep_until(clock.now_ns() + 1'000'000);
}

TEST(RealTimePath, TakesNoMemoryNoLockAndNoBlockingCall) {
  // Then nothing here counts.
  if (MALLOC_IS_TAKEN) GTEST_SKIP() << "the sanitizer replaces malloc itself";
  // The counting itself counts.
  const long before = blocking_calls;
  const timespec moment{0, 1};
  ASSERT_EQ(nanosleep(&moment, nullptr), 0);
  std::mutex mutex;
  mutex.lock();
  mutex.unlock();
  EXPECT_GE(blocking_calls - before, 2);

  hal::SteadyClock clock;
  const testing_support::TemporaryFolder folder;
  const hal::DeviceProfile profile =
      host::load_device_profile(testing_support::source_path("/hal/profiles/condyle_facebow.toml"));
  for (const int lag : {0, 16}) {
    ProbedSource source(kRate_Hz, clock);
    ReconnectingSource watched(source, clock);
    Configuration configuration;
    configuration.lag = lag;
    configuration.pose.emplace();
    const auto engine = std::make_unique<Engine>(watched, profile, configuration, clock);
    source.engine = engine.get();
    engine->start();
    wait_for_reports(source, 1000);
    hal::SessionLogWriter log;
    ASSERT_EQ(log.open(folder / (std::to_string(lag) + ".mcap"), testing_support::make_header()),
              hal::SessionLogFailure::none);
    (void)engine->begin_run(&log);
    // Nobody empties the ring, so that it is full at the end.
    wait_for_reports(source, source.reports + 6000);
    engine->stop();
    ASSERT_EQ(log.close(), hal::SessionLogFailure::none);
    EXPECT_GT(log.status().reports_written, 3000U);
    EXPECT_GT(engine->outlet().ring().dropped(), 0U);
    EXPECT_EQ(source.allocations, 0);
    EXPECT_EQ(source.calls, 0);
  }
}

// The same where a microcontroller estimates, which takes nothing.
TEST(RealTimePath, FeedsAMicrocontrollerLikewise) {
  if (MALLOC_IS_TAKEN) GTEST_SKIP() << "the sanitizer replaces malloc itself";
  hal::SteadyClock clock;
  const hal::DeviceProfile profile =
      host::load_device_profile(testing_support::source_path("/hal/profiles/condyle_facebow.toml"));
  ProbedSource source(kRate_Hz, clock);
  ReconnectingSource watched(source, clock);
  const auto feed = std::make_unique<NodeFeed>();
  const auto engine =
      std::make_unique<Engine>(watched, profile, Configuration(), clock, feed.get());
  source.engine = engine.get();
  engine->start();
  wait_for_reports(source, 4000);
  engine->stop();
  EXPECT_GT(feed->dropped(), 0U);
  EXPECT_EQ(source.allocations, 0);
  EXPECT_EQ(source.calls, 0);
}

}  // namespace
}  // namespace condyle::box
