// SPDX-License-Identifier: Apache-2.0
// What an instrument shows of a kinematic jaw, and what an examiner states of its landmarks.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "simulation/kinematic/kinematic_jaw.h"
#include "simulation/kinematic/true_readings.h"

namespace condyle::host {

class KinematicSimulation {
 public:
  KinematicSimulation(const JawScenario& scenario, std::uint64_t seed);
  /// Shares the jaw, and so its truth, among seeds. `scenario` gives the instrument, its mounting
  /// and the landmarks' errors, and may differ from the jaw's in these.
  KinematicSimulation(std::shared_ptr<const KinematicJaw> jaw, const JawScenario& scenario,
                      std::uint64_t seed);

  const KinematicJaw& jaw() const { return *jaw_; }
  /// Three points of the fork in the instrument's frame (m).
  const std::vector<Sample>& samples() const { return samples_; }
  /// True instant of each sample (s).
  const std::vector<double>& instants_s() const { return instants_s_; }
  /// In the instrument's frame, at the reference position.
  const JawLandmarks& stated_landmarks() const { return stated_; }
  const JawLandmarks& true_landmarks() const { return true_; }
  const std::vector<JawTaskSpan>& tasks() const { return jaw_->motion().tasks(); }

 private:
  std::shared_ptr<const KinematicJaw> jaw_;
  std::vector<Sample> samples_;
  std::vector<double> instants_s_;
  JawLandmarks true_, stated_;
};

}  // namespace condyle::host
