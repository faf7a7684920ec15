// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/report_tracker.h"

#include <random>

#include "support/rapidcheck_gtest.h"

namespace condyle::hal {
namespace {

constexpr TimeNs kMs = 1'000'000;

CountingField counting(std::uint32_t width_bits, std::uint64_t wraps_at = 0, double scale = 1) {
  CountingField result;
  result.field.width_bits = width_bits;
  result.field.type = FieldType::unsigned_integer;
  result.field.scale = scale;
  result.wraps_at = wraps_at;
  return result;
}

std::uint64_t wrapped(std::uint64_t count, const CountingField& field) {
  if (field.wraps_at != 0) return count % field.wraps_at;
  const std::uint32_t width = field.field.width_bits;
  return width == 64 ? count : count & ((std::uint64_t{1} << width) - 1);
}

TEST(SequenceCounter, FindsEveryLossOfMillionsOfReports) {
  for (const CountingField& field : {counting(8), counting(12), counting(32), counting(64),
                                     counting(8, 100), counting(16, 1001)}) {
    ReportContent profile;
    profile.sequence = field;
    profile.rate_Hz = 500;
    ReportTracker tracker(profile);
    std::mt19937_64 random(7);
    std::uint64_t sent = 0, duplicates = 0;
    // Starts just below the end of its bits.
    const std::uint64_t start = wrapped(~std::uint64_t{0}, field) - 3;
    while (sent < 1'000'000) {
      const std::uint64_t losses = random() % 10 == 0 ? random() % 49 : 0;
      if (sent > 0) sent += losses;
      DecodedReport report;
      report.sequence = wrapped(start + sent, field);
      const TimeNs host_time_ns = static_cast<TimeNs>(sent) * 2 * kMs;
      const TrackedReport tracked = tracker.accept(report, host_time_ns);
      ASSERT_EQ(tracked.sequence.sequence, sent);
      if (random() % 50 == 0) {
        ++duplicates;
        ASSERT_EQ(tracker.accept(report, host_time_ns).sequence.outcome,
                  SequenceOutcome::duplicated);
      }
      ++sent;
    }
    const ReportCounts& counts = tracker.counts();
    EXPECT_EQ(counts.received + counts.lost, sent);
    EXPECT_GT(counts.lost, 1000U);
    EXPECT_EQ(counts.duplicated, duplicates);
    EXPECT_EQ(counts.sequence_restarts + counts.unknown_losses, 0U);
  }
}

TEST(SequenceCounter, FindsLossesUpToHalfOfItsValues) {
  const std::uint64_t furthest[][2] = {
      {8, 128}, {16, 32768}, {32, std::uint64_t{1} << 31U}, {64, std::uint64_t{1} << 31U}};
  for (const auto& [width, ahead] : furthest) {
    const CountingField field = counting(static_cast<std::uint32_t>(width));
    SequenceCounter counter(field, 0, false);
    counter.advance(wrapped(200, field), 0);
    const SequenceStep far = counter.advance(wrapped(200 + ahead, field), 0);
    EXPECT_EQ(far.outcome, SequenceOutcome::lost);
    EXPECT_EQ(far.lost, ahead - 1);
    EXPECT_EQ(counter.advance(wrapped(200 + 2 * ahead + 1, field), 0).outcome,
              SequenceOutcome::restarted);
  }
}

TEST(SequenceCounter, NamesARestartAndGoesOn) {
  SequenceCounter counter(counting(32), 500, false);
  counter.advance(5000, 0);
  const SequenceStep restarted = counter.advance(0, 2 * kMs);
  EXPECT_EQ(restarted.outcome, SequenceOutcome::restarted);
  EXPECT_EQ(restarted.lost, 0U);
  EXPECT_EQ(restarted.sequence, 1U);
  EXPECT_EQ(counter.advance(1, 4 * kMs).outcome, SequenceOutcome::next);
}

TEST(SequenceCounter, SaysWhereALossCannotBeKnown) {
  SequenceCounter counter(counting(8), 500, false);
  counter.advance(10, 0);
  EXPECT_EQ(counter.advance(11, 250 * kMs).outcome, SequenceOutcome::next) << "below half a turn";
  EXPECT_EQ(counter.advance(12, 750 * kMs).outcome, SequenceOutcome::unknown_loss);
  EXPECT_EQ(counter.advance(13, 752 * kMs).outcome, SequenceOutcome::next);
}

TEST(SequenceCounter, ReconnectsAsTheProfileSays) {
  SequenceCounter runs_on(counting(32), 500, false);
  runs_on.advance(10, 0);
  runs_on.reconnect();
  EXPECT_EQ(runs_on.advance(400, 800 * kMs).lost, 389U);
  SequenceCounter restarts(counting(32), 500, true);
  restarts.reconnect();
  EXPECT_EQ(restarts.advance(10, 0).outcome, SequenceOutcome::first);
  restarts.reconnect();
  const SequenceStep back = restarts.advance(400, 800 * kMs);
  EXPECT_EQ(back.outcome, SequenceOutcome::unknown_loss) << "even where the counts would fit";
  EXPECT_EQ(back.lost, 0U);
  EXPECT_EQ(back.sequence, 1U);
}

RC_GTEST_PROP(SequenceCounter, NeverGoesBack, (const std::vector<std::uint64_t>& counts)) {
  const CountingField field = counting(*rc::gen::inRange<std::uint32_t>(2, 65));
  SequenceCounter counter(field, *rc::gen::element(0.0, 500.0), *rc::gen::arbitrary<bool>());
  std::uint64_t last = 0;
  for (const std::uint64_t count : counts) {
    if (count % 7 == 0) counter.reconnect();
    const SequenceStep step =
        counter.advance(wrapped(count, field), static_cast<TimeNs>(count * 0x9E3779B97F4A7C15U));
    RC_ASSERT(step.sequence >= last);
    last = step.sequence;
  }
}

TEST(ReportTracker, TellsUnknownReconnectionsFromPauses) {
  ReportContent profile;
  profile.sequence = counting(8);
  profile.rate_Hz = 500;
  profile.restarts_on_reconnect = true;
  ReportTracker tracker(profile);
  const auto accept = [&](std::uint64_t count, TimeNs time_ns) {
    DecodedReport report;
    report.sequence = count;
    static_cast<void>(tracker.accept(report, time_ns));
  };
  accept(100, 0);
  tracker.reconnect();
  accept(0, 5 * kMs);
  accept(1, 2005 * kMs);  // longer than the counter can tell
  EXPECT_EQ(tracker.counts().unknown_losses, 2U);
  EXPECT_EQ(tracker.counts().unknown_reconnections, 1U);
}

TEST(ReportTracker, CountsEveryOutcomeOnce) {
  ReportContent profile;
  profile.sequence = counting(16);
  ReportTracker tracker(profile);
  const auto accept = [&](std::uint64_t count) {
    DecodedReport report;
    report.sequence = count;
    static_cast<void>(tracker.accept(report, 0));
  };
  for (const std::uint64_t count : {1U, 2U, 2U, 5U, 0U}) accept(count);
  tracker.refuse(ReportFault::other_report);
  tracker.refuse(ReportFault::too_short);
  tracker.refuse(ReportFault::wrong_checksum);
  tracker.refuse(ReportFault::counter_out_of_range);
  tracker.refuse(ReportFault::unusable_profile);
  const ReportCounts& c = tracker.counts();
  EXPECT_EQ(c.received, 4U);
  EXPECT_EQ(c.lost, 2U);
  EXPECT_EQ(c.duplicated, 1U);
  EXPECT_EQ(c.sequence_restarts, 1U);
  EXPECT_EQ(c.unknown_losses, 0U);
  EXPECT_EQ(c.clock_jumps, 0U);
  EXPECT_EQ(c.other_reports, 1U);
  EXPECT_EQ(c.too_short, 1U);
  EXPECT_EQ(c.wrong_checksum, 1U);
  EXPECT_EQ(c.counter_out_of_range, 1U);
  EXPECT_EQ(c.unusable_profile, 1U);
}

TEST(ReportTracker, WithoutCounterOrClockTakesTheHosts) {
  ReportTracker tracker(ReportContent{});
  EXPECT_EQ(tracker.accept({}, 5 * kMs).sequence.outcome, SequenceOutcome::first);
  const TrackedReport second = tracker.accept({}, 7 * kMs);
  EXPECT_EQ(second.sequence.sequence, 1U);
  EXPECT_EQ(second.clock.time_ns, 7 * kMs);
  tracker.reconnect();
  EXPECT_EQ(tracker.accept({}, 9 * kMs).sequence.outcome, SequenceOutcome::unknown_loss);
  EXPECT_EQ(tracker.counts().unknown_losses, 1U);
}

}  // namespace
}  // namespace condyle::hal
