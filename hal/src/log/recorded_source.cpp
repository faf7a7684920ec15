// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/log/recorded_source.h"

namespace condyle::hal {

RecordedSource::RecordedSource(ReportSource& source, SessionLogWriter& log,
                               std::size_t source_index, Clock& clock)
    : source_(source),
      log_(log),
      source_index_(source_index),
      clock_(clock),
      recorded_(source.counts()) {}

Status RecordedSource::open() {
  const Status status = source_.open();
  record_faults();
  if (status == Status::ok) record(SessionEvent::connected, 1);
  return status;
}

Status RecordedSource::read(TimeNs deadline_ns, RawReport& report) {
  const Status status = source_.read(deadline_ns, report);
  record_faults();
  // The log counts and reports what is lost here.
  if (status == Status::ok) static_cast<void>(log_.write(source_index_, report));
  if (status == Status::disconnected) record(SessionEvent::disconnected, 1);
  return status;
}

void RecordedSource::record(SessionEvent kind, std::uint64_t count) {
  if (count == 0) return;
  static_cast<void>(log_.write_event(source_index_, clock_.now_ns(), kind, "", count));
}

void RecordedSource::record_faults() {
  const TransportCounts now = source_.counts();
  record(SessionEvent::stall, now.stalls - recorded_.stalls);
  record(SessionEvent::transfer_error, now.transfer_errors - recorded_.transfer_errors);
  record(SessionEvent::oversized, now.oversized - recorded_.oversized);
  recorded_ = now;
}

}  // namespace condyle::hal
