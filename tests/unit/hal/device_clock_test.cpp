// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "condyle/hal/report/report_tracker.h"
#include "support/rapidcheck_gtest.h"

namespace condyle::hal {
namespace {

constexpr TimeNs kMs = 1'000'000;
constexpr TimeNs kS = 1000 * kMs;
constexpr double kMicrosecond = 1e-6;

CountingField ticking(std::uint32_t width_bits, double tick_s, std::uint64_t wraps_at = 0) {
  CountingField result;
  result.field.width_bits = width_bits;
  result.field.type = FieldType::unsigned_integer;
  result.field.scale = tick_s;
  result.wraps_at = wraps_at;
  return result;
}

TEST(DeviceClock, IsExactOverDays) {
  // A week of microseconds through a clock that wraps every 71.6 minutes.
  DeviceClock clock(ticking(32, kMicrosecond), 500, false);
  std::mt19937_64 random(3);
  std::uint64_t ticks = 0xFFFF'0000;
  const TimeNs start_ns = 123'456'789;
  ASSERT_EQ(clock.advance(ticks, start_ns, 0).time_ns, start_ns);
  TimeNs elapsed_ns = 0;
  while (elapsed_ns < 7 * 86400 * kS) {
    const std::uint64_t step = random() % 2'000'000'000;
    ticks += step;
    elapsed_ns += static_cast<TimeNs>(step) * 1000;
    const auto late_ns = static_cast<TimeNs>(random() % 1'000'000'000);
    const ClockStep now = clock.advance(ticks & 0xFFFF'FFFFU, start_ns + elapsed_ns + late_ns, 0);
    ASSERT_EQ(now.outcome, ClockOutcome::next);
    ASSERT_EQ(now.time_ns, start_ns + elapsed_ns);
  }
}

TEST(DeviceClock, RoundsOddTicksWithoutAddingUp) {
  // 1/32768 s is 30517.578125 ns.
  DeviceClock clock(ticking(16, 1 / 32768.0), 0, false);
  clock.advance(0, 0, 0);
  TimeNs time_ns = 0;
  for (std::uint64_t second = 1; second <= 3600; ++second) {
    for (std::uint64_t part = 1; part <= 8; ++part) {
      const std::uint64_t ticks = (second - 1) * 32768 + part * 4096;
      time_ns = clock.advance(ticks % 65536, static_cast<TimeNs>(ticks) * 30518, 0).time_ns;
    }
    ASSERT_EQ(time_ns, static_cast<TimeNs>(second) * kS);
  }
}

TEST(DeviceClock, FindsTheWholeWrapsOfALongPause) {
  // 16 bits of 0.1 ms: 6.5536 s.
  for (const TimeNs pause_ns : {1 * kS, 7 * kS, 60 * kS, 86400 * kS}) {
    DeviceClock clock(ticking(16, 1e-4), 100, false);
    clock.advance(65000, 0, 0);
    const auto ticks = static_cast<std::uint64_t>(pause_ns / 100'000);
    const ClockStep now = clock.advance((65000 + ticks) % 65536, pause_ns + 20 * kMs, 0);
    EXPECT_EQ(now.time_ns, pause_ns);
    EXPECT_EQ(now.outcome, ClockOutcome::next);
  }
}

TEST(DeviceClock, BelievesTheReportsWhereTheHostIsLate) {
  // 16 bits of microseconds wrap every 65.5 ms, and the host has slept for a second.
  DeviceClock clock(ticking(16, kMicrosecond), 500, false);
  clock.advance(100, 0, 0);
  EXPECT_EQ(clock.advance(2100, 1000 * kMs, 1).time_ns, 2 * kMs);
  // 49 reports were lost: 100 ms are one wrap and 34.464 ms.
  const ClockStep later = clock.advance((2100 + 100'000) % 65536, 1000 * kMs + 1, 50);
  EXPECT_EQ(later.outcome, ClockOutcome::next);
  EXPECT_EQ(later.time_ns, 102 * kMs);
}

TEST(DeviceClock, BelievesTheHostWhereTheDevicePaused) {
  DeviceClock clock(ticking(16, 1e-4), 500, false);
  clock.advance(0, 0, 0);
  EXPECT_EQ(clock.advance(100'000 % 65536, 10 * kS, 1).time_ns, 10 * kS);
}

TEST(DeviceClock, NamesAJumpBackAndGoesOn) {
  DeviceClock clock(ticking(32, kMicrosecond), 500, false);
  clock.advance(5'000'000, 0, 0);
  const ClockStep jumped = clock.advance(0, 2 * kMs, 1);
  EXPECT_EQ(jumped.outcome, ClockOutcome::jumped_back);
  EXPECT_EQ(jumped.time_ns, 2 * kMs);
  const ClockStep next = clock.advance(2000, 4 * kMs, 1);
  EXPECT_EQ(next.outcome, ClockOutcome::next);
  EXPECT_EQ(next.time_ns, 4 * kMs);
}

TEST(DeviceClock, NamesAnAbsurdJumpAhead) {
  DeviceClock clock(ticking(64, kMicrosecond), 500, false);
  clock.advance(0, 0, 0);
  EXPECT_EQ(clock.advance(std::uint64_t{1} << 50U, 2 * kMs, 1).outcome, ClockOutcome::jumped_ahead);
  EXPECT_EQ(clock.advance(0, 4 * kMs, 1).outcome, ClockOutcome::jumped_back);
}

TEST(DeviceClock, NamesAnAbsurdPause) {
  // 16 bits of 0.1 ms: whole wraps alone reach so far.
  for (const TimeNs days : {365, 367}) {
    DeviceClock clock(ticking(16, 1e-4), 0, false);
    clock.advance(0, 0, 0);
    EXPECT_EQ(clock.advance(0, days * 86400 * kS, 0).outcome,
              days == 365 ? ClockOutcome::next : ClockOutcome::jumped_ahead);
  }
}

TEST(DeviceClock, ReconnectsAsTheProfileSays) {
  DeviceClock restarts(ticking(32, kMicrosecond), 500, true);
  restarts.advance(7'000'000, 0, 0);
  restarts.reconnect();
  const ClockStep anew = restarts.advance(12, 900 * kMs, 0);
  EXPECT_EQ(anew.outcome, ClockOutcome::restarted);
  EXPECT_EQ(anew.time_ns, 900 * kMs);
  DeviceClock runs_on(ticking(32, kMicrosecond), 500, false);
  runs_on.advance(7'000'000, 0, 0);
  runs_on.reconnect();
  EXPECT_EQ(runs_on.advance(7'800'000, 900 * kMs, 0).time_ns, 800 * kMs);
}

TEST(DeviceClock, GoesOnFromOneEndOfTimeToTheOther) {
  DeviceClock clock(ticking(32, kMicrosecond), 500, true);
  constexpr TimeNs lowest = std::numeric_limits<TimeNs>::min();
  constexpr TimeNs highest = std::numeric_limits<TimeNs>::max();
  clock.advance(0, lowest, 0);
  clock.reconnect();
  EXPECT_EQ(clock.advance(0, highest, 0).time_ns, highest);
  EXPECT_EQ(clock.advance(1000, highest, 0).outcome, ClockOutcome::jumped_ahead);
}

TEST(DeviceClock, CountsItsJumps) {
  ReportContent profile;
  profile.device_time = ticking(32, kMicrosecond);
  ReportTracker tracker(profile);
  for (const std::uint64_t ticks : {100U, 200U, 0U, 100U}) {
    DecodedReport report;
    report.device_time = ticks;
    static_cast<void>(tracker.accept(report, 0));
  }
  EXPECT_EQ(tracker.counts().clock_jumps, 1U);
}

// Whatever device and host say, time stays in int64 and never goes back.
RC_GTEST_PROP(DeviceClock, NeverGoesBack, ()) {
  const auto width = *rc::gen::inRange<std::uint32_t>(1, 65);
  DeviceClock clock(ticking(width, *rc::gen::element(1e-9, kMicrosecond, 1 / 32768.0, 3600.0)),
                    *rc::gen::element(0.0, 500.0), *rc::gen::arbitrary<bool>());
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  TimeNs last = std::numeric_limits<TimeNs>::min();
  for (int i = 0; i < 200; ++i) {
    if (random() % 20 == 0) clock.reconnect();
    const std::uint64_t ticks = random() >> (64 - width);
    const auto host_time_ns = static_cast<TimeNs>(random() << random() % 64);
    const ClockStep step = clock.advance(ticks, host_time_ns, random() >> random() % 64);
    RC_ASSERT(step.time_ns >= last);
    last = step.time_ns;
  }
}

}  // namespace
}  // namespace condyle::hal
