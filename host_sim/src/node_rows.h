// SPDX-License-Identifier: Apache-2.0
// Rows of estimates from what a target sends.
#pragma once

#include <deque>
#include <optional>

#include "condyle/hal/device_facebow.h"
#include "condyle/hal/link_messages.h"
#include "estimate_row.h"

namespace condyle::host {

/// Reads the estimates of one run. For the published cascade, whose estimates do not say what was
/// measured, reports are decoded here as well.
class NodeRows {
 public:
  /// `scalar_size`: of the target's numbers (bytes), 4 or 8.
  NodeRows(const hal::ReportLayout& layout, FollowedCoordinate followed, bool is_published,
           unsigned scalar_size);

  /// A report that is sent.
  void add(const hal::RawReport& report);
  /// The row of an estimate's frame; none while a lag fills, and where it cannot be read.
  std::optional<EstimateRow> row_of(const hal::LinkFrame& frame);
  /// Frames that could not be read.
  std::uint64_t unreadable() const { return unreadable_; }

 private:
  // One report at a time.
  class OneReport final : public hal::ReportSource {
   public:
    hal::Status open() override { return hal::Status::ok; }
    hal::Status read(TimeNs, hal::RawReport& report) override;
    void close() override {}
    hal::TransportCounts counts() const override { return {}; }
    void set(const hal::RawReport& report) { report_ = &report; }

   private:
    const hal::RawReport* report_ = nullptr;
  };

  template <class Scalar>
  std::optional<EstimateRow> row_in(const hal::LinkFrame& frame);
  Sample sample_of(const hal::SampleStamp& stamp);

  FollowedCoordinate followed_;
  bool is_published_;
  unsigned scalar_size_;
  OneReport source_;
  hal::DeviceFacebow facebow_;
  std::deque<Sample> samples_;  // of reports that have no estimate yet
  std::uint64_t unreadable_ = 0;
};

}  // namespace condyle::host
