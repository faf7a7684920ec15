// SPDX-License-Identifier: Apache-2.0
// The recommended estimator's results beside exported measurements.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "condyle/estimator/sensors/recommended_parameters.h"
#include "condyle/hal/clock.h"
#include "estimation/estimate_row.h"
#include "recordings/recording_choice.h"
#include "recordings/replay_facebow.h"

namespace condyle::host {

/// Estimates of a recording, computed while they are taken.
class ExportEstimates {
 public:
  /// Without delay, with default parameters or those that the recording holds. `resample_Hz`: see
  /// ResampledRows. Throws InputError if the recording has no single point to follow.
  ExportEstimates(const std::string& source, RecordingChoice choice,
                  std::optional<double> resample_Hz, std::function<bool()> is_stopped);

  int axis_count() const { return info_.kind == SampleKind::one_axis ? 1 : 3; }
  bool has_impedance() const { return info_.has_drive; }
  /// What is followed: "one axis"; "point 1, axis z".
  std::string followed() const { return choice_.text(info_.kind); }
  /// The followed point; see FollowedPoint.
  FollowedPoint point() const { return choice_.point(); }
  double assumed_mass_kg() const { return parameters_.assumed_mass_kg; }

  /// Passes each row to `take`, until `is_stopped`; once.
  void run(const std::function<void(const EstimateRow&)>& take);

 private:
  std::string source_;
  RecordingChoice choice_;
  std::optional<double> resample_Hz_;
  std::function<bool()> is_stopped_;
  hal::SteadyClock clock_;
  ReplayFacebow facebow_;
  RecordingInfo info_;
  RecommendedParameters parameters_;
};

}  // namespace condyle::host
