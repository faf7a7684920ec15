// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/report_tracker.h"

namespace condyle::hal {

ReportTracker::ReportTracker(const ReportContent& content) {
  const bool restarts = content.restarts_on_reconnect;
  if (content.sequence) counter_.emplace(*content.sequence, content.rate_Hz, restarts);
  if (content.device_time) clock_.emplace(*content.device_time, content.rate_Hz, restarts);
}

TrackedReport ReportTracker::accept(const DecodedReport& report, TimeNs host_time_ns) {
  SequenceStep& step = last_.sequence;
  if (counter_ && report.sequence) {
    step = counter_->advance(*report.sequence, host_time_ns);
  } else if (counts_.received == 0) {
    step = {};
  } else {
    const bool is_gap = is_reconnected_;
    step = {is_gap ? SequenceOutcome::unknown_loss : SequenceOutcome::next, step.sequence + 1, 0};
  }
  const bool is_unknown = step.outcome == SequenceOutcome::unknown_loss;
  counts_.unknown_reconnections += is_unknown && is_reconnected_ ? 1 : 0;
  is_reconnected_ = false;
  counts_.lost += step.lost;
  counts_.sequence_restarts += step.outcome == SequenceOutcome::restarted ? 1 : 0;
  counts_.unknown_losses += is_unknown ? 1 : 0;
  if (step.outcome == SequenceOutcome::duplicated) {
    counts_.duplicated += 1;
    return last_;
  }
  counts_.received += 1;
  if (clock_ && report.device_time) {
    const bool is_counted = counter_ && (step.outcome == SequenceOutcome::next ||
                                         step.outcome == SequenceOutcome::lost);
    last_.clock =
        clock_->advance(*report.device_time, host_time_ns, is_counted ? step.lost + 1 : 0);
  } else {
    last_.clock = {counts_.received == 1 ? ClockOutcome::first : ClockOutcome::next, host_time_ns};
  }
  counts_.clock_jumps += last_.clock.outcome == ClockOutcome::jumped_back ||
                                 last_.clock.outcome == ClockOutcome::jumped_ahead
                             ? 1
                             : 0;
  return last_;
}

void ReportTracker::refuse(ReportFault fault) {
  switch (fault) {
    case ReportFault::none:
      break;
    case ReportFault::other_report:
      counts_.other_reports += 1;
      break;
    case ReportFault::too_short:
      counts_.too_short += 1;
      break;
    case ReportFault::wrong_checksum:
      counts_.wrong_checksum += 1;
      break;
    case ReportFault::counter_out_of_range:
      counts_.counter_out_of_range += 1;
      break;
    case ReportFault::unusable_profile:
      counts_.unusable_profile += 1;
      break;
  }
}

void ReportTracker::reconnect() {
  is_reconnected_ = true;
  if (counter_) counter_->reconnect();
  if (clock_) clock_->reconnect();
}

}  // namespace condyle::hal
