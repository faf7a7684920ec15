// SPDX-License-Identifier: Apache-2.0
// An analysis on a thread of its own that its owner can end early.
#pragma once

#include <functional>
#include <string>

#include "readings/analysis.h"

namespace condyle::host {

/// Thrown by an analysis that was asked to stop.
struct AnalysisStopped {};

/// As analyse(source, choice). `should_stop` is asked between parts of the work, on any thread;
/// true ends it with AnalysisStopped.
Analysis analyse_until(const std::string& source, const AnalysisChoice& choice,
                       const std::function<bool()>& should_stop);

/// Throws AnalysisStopped if `should_stop` is given and true.
inline void stop_if_asked(const std::function<bool()>& should_stop) {
  if (should_stop && should_stop()) throw AnalysisStopped();
}

}  // namespace condyle::host
