// SPDX-License-Identifier: Apache-2.0
// Rows of estimates from the frames of a microcontroller.
#pragma once

#include <cstdint>
#include <optional>

#include "condyle/hal/link/link_messages.h"
#include "estimation/estimate_row.h"

namespace condyle::host {

/// Reads the estimates of one run.
class NodeRows {
 public:
  /// `axis_count`: 1 or 3, or 0 for the published cascade; `scalar_size`: size of the
  /// microcontroller's numbers, 4 or 8 (bytes); `has_impedance`: friction and mass are identified.
  NodeRows(int axis_count, FollowedCoordinate followed, unsigned scalar_size, bool has_impedance)
      : axis_count_(axis_count),
        followed_(followed),
        scalar_size_(scalar_size),
        has_impedance_(has_impedance) {}

  /// The row of an estimate's frame, without the measured position if it is the published
  /// cascade's; none while a lag fills, or if it cannot be read.
  std::optional<EstimateRow> row_of(const hal::LinkFrame& frame);
  /// Takes a conclusion; the rows after it contain it.
  void take_conclusion(const hal::LinkFrame& frame);
  /// The last one.
  const ImpedanceEstimate<double>& conclusion() const { return conclusion_; }
  /// Frames that could not be read, or belong to another run.
  std::uint64_t unreadable() const { return unreadable_; }

 private:
  template <class Scalar>
  void take_in(const hal::LinkFrame& frame);
  template <class Scalar>
  std::optional<EstimateRow> row_in(const hal::LinkFrame& frame);

  int axis_count_;
  FollowedCoordinate followed_;
  unsigned scalar_size_;
  bool has_impedance_;
  ImpedanceEstimate<double> conclusion_;
  std::uint64_t unreadable_ = 0;
};

}  // namespace condyle::host
