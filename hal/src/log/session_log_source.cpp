// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/log/session_log_source.h"

#include <utility>

namespace condyle::hal {

SessionLogSource::SessionLogSource(std::string path, std::size_t source_index, Clock* clock)
    : path_(std::move(path)), source_index_(source_index), clock_(clock) {}

Status SessionLogSource::open() {
  if (!has_begun_) {
    const Status status = reader_.open(path_);
    if (status != Status::ok) return status;
    has_source_ = source_index_ < reader_.header().sources.size();
    if (!has_source_) return Status::bad_report;
    has_begun_ = true;
  }
  is_open_ = true;
  return Status::ok;
}

Status SessionLogSource::read(TimeNs deadline_ns, RawReport& report) {
  if (!is_open_) return Status::not_open;
  for (;;) {
    if (!has_entry_) {
      const McapRead outcome = reader_.next(entry_);
      if (outcome == McapRead::damaged && !std::exchange(has_failed_, true)) {
        return Status::bad_report;
      }
      if (outcome != McapRead::record) return Status::end;
      has_entry_ = entry_.source_index == source_index_;
      if (!has_entry_) continue;
    }
    if (clock_ != nullptr) {
      const TimeNs due_ns = entry_.is_event ? entry_.event.time_ns : entry_.report.host_time_ns;
      clock_->sleep_until(due_ns < deadline_ns ? due_ns : deadline_ns);
      if (due_ns > deadline_ns) return Status::timeout;
    }
    has_entry_ = false;
    if (!entry_.is_event) {
      report = entry_.report;
      return Status::ok;
    }
    if (!take_event(entry_.event)) {
      is_open_ = false;
      return Status::disconnected;
    }
  }
}

// False if the device went away.
bool SessionLogSource::take_event(const SessionEventRecord& event) {
  switch (event.kind) {
    case SessionEvent::disconnected:
      ++counts_.disconnections;
      return false;
    case SessionEvent::stall:
      counts_.stalls += event.count;
      break;
    case SessionEvent::transfer_error:
      counts_.transfer_errors += event.count;
      break;
    case SessionEvent::oversized:
      counts_.oversized += event.count;
      break;
    case SessionEvent::not_recorded:
      not_recorded_ += event.count;
      break;
    case SessionEvent::connected:
    case SessionEvent::note:
      break;
  }
  return true;
}

std::string SessionLogSource::problem() const {
  if (!has_source_) return "the log has no source " + std::to_string(source_index_);
  const McapRead outcome = condition().outcome;
  const bool is_well = outcome == McapRead::record || outcome == McapRead::end;
  return is_well ? std::string() : describe(condition());
}

}  // namespace condyle::hal
