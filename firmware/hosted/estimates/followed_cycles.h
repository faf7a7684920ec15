// SPDX-License-Identifier: Apache-2.0
// Chewing cycles of the followed point, from the recommended estimator's estimates.
#pragma once

#include <optional>
#include <string>

#include "condyle/estimator/motion/motion_cycles.h"
#include "condyle/estimator/motion/recommended_estimate.h"
#include "hosted/estimates/estimate_fields.h"

namespace condyle::host {

/// The user's choice.
struct CycleChoice {
  Axis followed = Axis::z;    ///< the jaw opens and closes along it
  bool closes_upward = true;  ///< the followed coordinate grows when the jaw closes
};

/// A cycle with its place among the others.
struct FoundCycle {
  MotionCycle<double> cycle;
  int number = 0;    ///< of those taken, from 1; 0: it is not taken
  int sequence = 1;  ///< a pause of more than 2 s begins a new one
};

/// Finds cycles as they end. Speeds are in space if the point has three coordinates, else along the
/// axis. An estimate counts if its own sample was used.
class FollowedCycles {
 public:
  explicit FollowedCycles(const CycleChoice& choice) : choice_(choice) {}

  /// The next estimate; the cycle that has ended with it.
  std::optional<FoundCycle> add(const RecommendedEstimate<double>& estimate);
  /// After the last estimate: the cycle that its end ends.
  std::optional<FoundCycle> finish();
  /// Forgets an unfinished cycle, as after a restart of the clock or of the estimator.
  void restart() { cycles_.reset(); }

 private:
  FoundCycle place(const MotionCycle<double>& cycle);

  CycleChoice choice_;
  MotionCycles<double> cycles_;
  std::optional<TimeNs> last_end_ns_;
  int taken_ = 0, sequence_ = 0;
};

/// Calls `visit(name, quantity)` for the quantities of a cycle, in the order of the columns.
template <class Visit>
void visit_cycle(const MotionCycle<double>& cycle, Visit&& visit) {
  visit(QuantityName{"duration", "s"}, cycle.duration_s);
  visit(QuantityName{"opening_time", "s"}, cycle.opening_time_s);
  visit(QuantityName{"closing_time", "s"}, cycle.closing_time_s);
  visit(QuantityName{"height", "m"}, cycle.height_m);
  visit(QuantityName{"opening_peak_speed", "m_s"}, cycle.opening_peak_speed_m_s);
  visit(QuantityName{"closing_peak_speed", "m_s"}, cycle.closing_peak_speed_m_s);
}

/// Why a cycle is not taken, with the number that decides; empty if it is taken.
std::string rejection_text(const MotionCycle<double>& cycle);

}  // namespace condyle::host
