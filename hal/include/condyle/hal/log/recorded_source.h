// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "condyle/hal/clock.h"
#include "condyle/hal/log/session_log.h"

namespace condyle::hal {

/// Passes a source's reports on and records them, with its connections, disconnections and faults,
/// so that SessionLogSource reproduces the source. If the log fails or is full, reports still come,
/// and SessionLogWriter::status has the failure.
class RecordedSource final : public ReportSource {
 public:
  /// `source_index`: of `source` in the log's header. `clock`: the clock of its reports.
  RecordedSource(ReportSource& source, SessionLogWriter& log, std::size_t source_index,
                 Clock& clock);

  Status open() override;
  Status read(TimeNs deadline_ns, RawReport& report) override;
  void close() override { source_.close(); }
  TransportCounts counts() const override { return source_.counts(); }

 private:
  void record(SessionEvent kind, std::uint64_t count);
  void record_faults();

  ReportSource& source_;
  SessionLogWriter& log_;
  std::size_t source_index_;
  Clock& clock_;
  TransportCounts recorded_;
};

}  // namespace condyle::hal
