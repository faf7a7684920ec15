// SPDX-License-Identifier: Apache-2.0
// A session replayed is the session recorded: the same outcomes, reports and counts, in order.
#include "condyle/hal/log/recorded_source.h"

#include <vector>

#include "condyle/hal/facebow.h"
#include "condyle/hal/log/session_log_source.h"
#include "support/rapidcheck_gtest.h"
#include "support/session.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using hal::Status;

// What a device does at one read: a report, an unplugging, faults, silence.
struct Step {
  Status outcome = Status::ok;
  std::uint64_t stalls = 0, transfer_errors = 0, oversized = 0;
};

class ScriptedSource final : public hal::ReportSource {
 public:
  ScriptedSource(std::vector<Step> steps, hal::ManualClock& clock)
      : steps_(std::move(steps)), clock_(clock) {}

  Status open() override { return Status::ok; }
  Status read(TimeNs, hal::RawReport& report) override {
    if (next_ == steps_.size()) return Status::end;
    const Step& step = steps_[next_++];
    clock_.sleep_until(clock_.now_ns() + 2'000'000);
    counts_.stalls += step.stalls;
    counts_.transfer_errors += step.transfer_errors;
    counts_.oversized += step.oversized;
    counts_.disconnections += step.outcome == Status::disconnected ? 1U : 0U;
    if (step.outcome == Status::ok) {
      report = testing_support::make_report(static_cast<std::uint32_t>(next_), 29, clock_.now_ns());
    }
    return step.outcome;
  }
  void close() override {}
  hal::TransportCounts counts() const override { return counts_; }

 private:
  std::vector<Step> steps_;
  hal::ManualClock& clock_;
  std::size_t next_ = 0;
  hal::TransportCounts counts_;
};

struct Session {
  std::vector<Status> outcomes;  // but timeouts, of which a log knows nothing
  std::vector<hal::RawReport> reports;
  hal::TransportCounts counts;
};

Session run(hal::ReportSource& source) {
  Session session;
  hal::RawReport report;
  Status status = source.open();
  while (status != Status::end) {
    status = source.read(hal::kNoDeadline, report);
    if (status != Status::timeout) session.outcomes.push_back(status);
    if (status == Status::ok) session.reports.push_back(report);
    if (status == Status::disconnected && source.open() != Status::ok) break;
  }
  session.counts = source.counts();
  return session;
}

RC_GTEST_PROP(RecordedSession, IsReplayedAsItWas, ()) {
  std::vector<Step> steps(*rc::gen::inRange<std::size_t>(0, 60));
  for (Step& step : steps) {
    step.outcome = *rc::gen::weightedElement<Status>(
        {{10, Status::ok}, {1, Status::disconnected}, {1, Status::timeout}});
    if (*rc::gen::inRange(0, 6) == 0) step.stalls = *rc::gen::inRange(0U, 1000U);
    if (*rc::gen::inRange(0, 6) == 0) step.transfer_errors = *rc::gen::inRange(0U, 3U);
    if (*rc::gen::inRange(0, 6) == 0) step.oversized = *rc::gen::inRange(0U, 3U);
  }
  const testing_support::TemporaryFolder folder;
  hal::ManualClock clock;
  ScriptedSource device(steps, clock);
  hal::SessionLogWriter log;
  RC_ASSERT(log.open(folder / "log.mcap", testing_support::make_header()) ==
            hal::SessionLogFailure::none);
  hal::RecordedSource recorded(device, log, 0, clock);
  const Session live = run(recorded);
  RC_ASSERT(log.close() == hal::SessionLogFailure::none);
  RC_ASSERT(log.status().reports_lost + log.status().events_lost == 0U);

  hal::SessionLogSource source(folder / "log.mcap");
  const Session replayed = run(source);
  RC_ASSERT(replayed.outcomes == live.outcomes);
  RC_ASSERT(replayed.reports.size() == live.reports.size());
  for (std::size_t i = 0; i < live.reports.size(); ++i) {
    RC_ASSERT(testing_support::is_same(replayed.reports[i], live.reports[i]));
  }
  RC_ASSERT(replayed.counts.stalls == live.counts.stalls);
  RC_ASSERT(replayed.counts.transfer_errors == live.counts.transfer_errors);
  RC_ASSERT(replayed.counts.oversized == live.counts.oversized);
  RC_ASSERT(replayed.counts.disconnections == live.counts.disconnections);
}

TEST(RecordedSource, GoesOnWhereNothingCanBeRecorded) {
  hal::ManualClock clock;
  ScriptedSource device(std::vector<Step>(5), clock);
  hal::SessionLogWriter never_opened;
  hal::RecordedSource recorded(device, never_opened, 0, clock);
  EXPECT_EQ(run(recorded).reports.size(), 5U);
  EXPECT_EQ(never_opened.status().reports_lost, 5U);
}

}  // namespace
}  // namespace condyle
