// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "hosted/devices/facebow_report.h"
#include "recordings/recording.h"

namespace condyle::host::fake {

/// The motion of the fake facebow: the rows of a recording, one for each report, regardless of
/// their times. A recording of one axis or one point moves all three points alike, the axis along
/// z.
class Motion {
 public:
  /// Opens a recording at its start; called again when it repeats.
  using Opener = std::function<std::unique_ptr<Recording>()>;

  /// InputError if the recording cannot be sent: a pose, or no rows.
  Motion(Opener open, bool repeats);

  /// Coordinates of the next row; false at the end. InputError if the recording is faulty or a
  /// coordinate exceeds the report's 0.131 m.
  bool next(RawCoordinates& coordinates);

  /// Mean rate of the recording's first rows, from their times; absent if they have none.
  std::optional<double> rate_Hz() const { return rate_Hz_; }
  /// Share of the recording sent, 0 to 1; starts again when it repeats.
  double progress() const { return recording_->progress(); }

 private:
  void reopen();

  Opener open_;
  bool repeats_;
  std::unique_ptr<Recording> recording_;
  std::optional<double> rate_Hz_;
};

}  // namespace condyle::host::fake
