// SPDX-License-Identifier: Apache-2.0
// What the cycles of chewing truly are: noise-free poses every 0.5 ms.
#pragma once

#include <string>
#include <vector>

#include "simulation/kinematic/kinematic_jaw.h"
#include "simulation/kinematic/true_measures.h"

namespace condyle::host {

/// A reading of a cycle or of all cycles.
struct TrueCycleValue {
  std::string reading;
  double value;
  const char* unit;
  JawSide side = JawSide::none;
};

struct TrueCycle {
  int number = 0;                ///< as JawCycle::cycle
  JawSide side = JawSide::none;  ///< to which the jaw closes by 1 mm or more; none: midline
  bool is_reversed = false;      ///< it closes nearer to the midline than it opens
  std::vector<TrueCycleValue> values;
};

class TruthOfCycles {
 public:
  TruthOfCycles(const KinematicJaw& jaw, const std::vector<JawCycle>& cycles);

  const std::vector<TrueCycle>& cycles() const { return true_; }
  const std::vector<TrueCycleValue>& summary() const { return summary_; }

 private:
  Eigen::Vector3d incisor_mm(double time_s) const;
  double speed_mm_s(double time_s) const;
  double upward_mm_s(double time_s) const;
  void read_times(std::size_t at, TrueCycle& into) const;
  void read_sizes(const JawCycle& cycle, TrueCycle& into) const;
  void read_loop(const JawCycle& cycle, TrueCycle& into) const;
  void summarise();
  void add_scatter(const std::string& of, const std::string& sd, const std::string& relative,
                   const std::string& change, const char* unit);

  const KinematicJaw& jaw_;
  const std::vector<JawCycle>& cycles_;
  std::vector<TrueCycle> true_;
  std::vector<TrueCycleValue> summary_;
};

}  // namespace condyle::host
