// SPDX-License-Identifier: Apache-2.0
// A facebow: reports from a source, decoded by a layout, with times on the host's clock. Live
// devices, session logs and captures all pass through here, so that a replay repeats the live run.
#pragma once

#include "condyle/hal/facebow.h"
#include "condyle/hal/report/clock_fit.h"
#include "condyle/hal/report/raw_report.h"
#include "condyle/hal/report/report_decoder.h"
#include "condyle/hal/report/report_tracker.h"

namespace condyle::hal {

/// See Facebow. Reading allocates nothing.
class DeviceFacebow final : public Facebow {
 public:
  /// `source` delivers the reports of the device that `layout` describes: layout_of(profile)
  /// (profile_check.h), if there is a profile.
  DeviceFacebow(ReportSource& source, const ReportLayout& layout)
      : source_(source), decoder_(layout), tracker_(layout) {}

  Status open() override;
  /// bad_report if a report could not be decoded by the layout; last_fault() gives the reason.
  /// Reports with another id and duplicates are skipped and counted. Sample::time_ns is the
  /// device's clock on the host's (clock_fit.h), or the arrival if the layout has no clock.
  Status read(TimeNs deadline_ns, Sample& sample) override;
  void close() override { source_.close(); }

  /// Counts of the reports so far.
  const ReportCounts& counts() const { return tracker_.counts(); }
  TransportCounts transport_counts() const { return source_.counts(); }
  /// How the device's clock relates to the host's.
  const ClockFit& clock_fit() const { return clock_fit_; }
  /// Why the last report was refused.
  ReportFault last_fault() const { return last_fault_; }
  /// The last accepted report, with the values that a sample does not hold.
  const DecodedReport& last_report() const { return report_; }
  /// Its arrival on the host's clock.
  TimeNs last_arrival_ns() const { return raw_.host_time_ns; }

 private:
  ReportSource& source_;
  ReportDecoder decoder_;
  ReportTracker tracker_;
  ClockFit clock_fit_;
  RawReport raw_;
  DecodedReport report_;
  ReportFault last_fault_ = ReportFault::none;
  bool was_away_ = false;
};

}  // namespace condyle::hal
