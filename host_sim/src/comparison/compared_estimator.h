// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/drive_statement.h"
#include "estimation/estimate_row.h"
#include "estimation/estimator_choice.h"
#include "recordings/drive_channel.h"
#include "recordings/recording_choice.h"
#include "recordings/replay_facebow.h"

namespace condyle::host {

/// One of several estimators that see the samples of one recording.
class ComparedEstimator {
 public:
  virtual ~ComparedEstimator() = default;
  /// The row of `lag` samples ago, after `sample`; none while the lag fills.
  virtual std::optional<EstimateRow> process(const Sample& sample, EventSet events) = 0;
  /// After the last sample: the next row that is still delayed by the lag.
  virtual std::optional<EstimateRow> drain() = 0;
  /// True if it learns noise and jerk from the recording.
  virtual bool estimates_noise() const = 0;
  /// What the drive showed up to now; none without a drive.
  virtual std::optional<ImpedanceEstimate<double>> conclude() { return std::nullopt; }
  /// Problems of the drive, one line each.
  virtual std::vector<std::string> drive_notes() const { return {}; }
};

/// What else an estimator takes; each may be null.
struct ComparedExtras {
  BodyFits* fits = nullptr;       ///< receives how the fits of a body went
  DriveChannel* drive = nullptr;  ///< of a recording without a drive of its own
};

/// The estimator that `option` names, as replay sets it up for the recording `source`, which is
/// open in `facebow`. Problems are InputErrors.
std::unique_ptr<ComparedEstimator> make_compared_estimator(
    const EstimatorChoice& option, const RecordingChoice& choice, const DriveStatement& drive,
    const std::string& source, const ReplayFacebow& facebow, const ComparedExtras& extras = {});

/// The parameters that it gives the recommended estimator.
RecommendedParameters compared_parameters(const EstimatorChoice& option,
                                          const DriveStatement& drive, const std::string& source,
                                          const RecordingInfo& info);

}  // namespace condyle::host
