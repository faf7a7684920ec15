// SPDX-License-Identifier: Apache-2.0
// A facebow: reports from a source, read as a layout says, at the times of the host's clock. Live
// devices, session logs and captures all come through here, so that a replay is the live run again.
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
  /// `source` gives the reports of the device that `layout` describes: layout_of(profile)
  /// (profile_check.h), where there is a profile.
  DeviceFacebow(ReportSource& source, const ReportLayout& layout)
      : source_(source), decoder_(layout), tracker_(layout) {}

  Status open() override;
  /// bad_report where one could not be read as the layout says; last_fault() tells why. Reports of
  /// other numbers and duplicates are passed over, and counted. Sample::time_ns is the device's
  /// clock on the host's (clock_fit.h), or the arrival where the layout has no clock.
  Status read(TimeNs deadline_ns, Sample& sample) override;
  void close() override { source_.close(); }

  /// What became of the reports so far.
  const ReportCounts& counts() const { return tracker_.counts(); }
  TransportCounts transport_counts() const { return source_.counts(); }
  /// How the device's clock lies to the host's.
  const ClockFit& clock_fit() const { return clock_fit_; }
  /// Why the last report was refused.
  ReportFault last_fault() const { return last_fault_; }
  /// The last report taken, with what a sample does not hold.
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
