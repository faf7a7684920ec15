// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "condyle/firmware/latency_histogram.h"
#include "condyle/hal/clock.h"
#include "condyle/hal/report/raw_report.h"

namespace condyle::host {

/// A jaw that chews endlessly, with the reports of condyle's fake facebow, each delivered when its
/// time comes. So it also shows how late this machine wakes a thread.
class SyntheticSource final : public hal::ReportSource {
 public:
  SyntheticSource(double rate_Hz, hal::Clock& clock) : rate_Hz_(rate_Hz), clock_(clock) {}

  hal::Status open() override;
  hal::Status read(TimeNs deadline_ns, hal::RawReport& report) override;
  void close() override { is_open_ = false; }
  hal::TransportCounts counts() const override { return {}; }

  /// Delay of reports for which the thread slept: from the due time to delivery.
  const firmware::LatencyHistogram& wake_up() const { return wake_up_; }

 private:
  TimeNs due_ns() const;
  std::int16_t noisy_units(double position_m);

  double rate_Hz_;
  hal::Clock& clock_;
  bool is_open_ = false;
  TimeNs begin_ns_ = 0;
  std::uint64_t counter_ = 0;
  std::uint32_t random_ = 1;
  firmware::LatencyHistogram wake_up_;
};

}  // namespace condyle::host
