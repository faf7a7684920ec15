// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/device_facebow.h"

#include <algorithm>

namespace condyle::hal {

Status DeviceFacebow::open() {
  const Status status = source_.open();
  if (status == Status::ok && was_away_) {
    tracker_.reconnect();
    was_away_ = false;
  }
  return status;
}

Status DeviceFacebow::read(TimeNs deadline_ns, Sample& sample) {
  for (;;) {
    const Status status = source_.read(deadline_ns, raw_);
    was_away_ = was_away_ || status == Status::disconnected;
    if (status != Status::ok) return status;
    const ReportFault fault = decoder_.decode(raw_.data(), report_);
    if (fault != ReportFault::none) {
      tracker_.refuse(fault);
      if (fault == ReportFault::other_report) continue;
      last_fault_ = fault;
      return Status::bad_report;
    }
    const TrackedReport tracked = tracker_.accept(report_, raw_.host_time_ns);
    if (tracked.sequence.outcome == SequenceOutcome::duplicated) continue;

    sample = Sample();
    sample.time_ns = raw_.host_time_ns;
    if (report_.device_time) {
      const ClockOutcome clock = tracked.clock.outcome;
      if (clock != ClockOutcome::first && clock != ClockOutcome::next) clock_fit_.restart();
      sample.time_ns = clock_fit_.add(tracked.clock.time_ns, raw_.host_time_ns);
    }
    sample.sequence = tracked.sequence.sequence;
    sample.kind = report_.kind;
    std::copy(report_.coordinates.begin(), report_.coordinates.end(), sample.coordinates);
    sample.position_valid = report_.position_valid;
    sample.drive_N = report_.drive_N;
    sample.drive_valid = report_.drive_valid;
    return Status::ok;
  }
}

}  // namespace condyle::hal
