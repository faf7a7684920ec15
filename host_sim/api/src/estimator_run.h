// SPDX-License-Identifier: Apache-2.0
// A virtual sensor of any type behind one interface, sample by sample.
#pragma once

#include <memory>

#include "estimation/drive_statement.h"
#include "estimation/estimate_row.h"
#include "estimation/estimator_choice.h"
#include "recordings/followed_choice.h"
#include "recordings/recording.h"

namespace condyle::host {

/// What determines a run.
struct RunChoice : FollowedChoice {
  SampleKind kind = SampleKind::one_axis;
  bool has_drive = false;
  double step_s = 0;  ///< between samples; 0: not known
  EstimatorChoice estimator;
  DriveStatement drive;
  RecordingOptions reading;  ///< only its faults
};

/// A run of an estimator.
class EstimatorRun {
 public:
  virtual ~EstimatorRun() = default;
  /// The estimate that is ready after `sample`; null while a lag fills. It lives until the next
  /// call.
  virtual const EstimateRow* process(const Sample& sample) = 0;
  /// After the last sample: the next estimate that waited, or null.
  virtual const EstimateRow* drain() = 0;
  /// True if velocity and acceleration are corrected by what is learned from the samples.
  virtual bool learns() const { return false; }
  /// Friction and mass from everything so far; null without a drive.
  virtual const ImpedanceEstimate<double>* conclude() { return nullptr; }
};

/// The run for `choice`. Throws InputError if its options or parameters cannot be used.
std::unique_ptr<EstimatorRun> make_estimator_run(const RunChoice& choice);

}  // namespace condyle::host
