// SPDX-License-Identifier: Apache-2.0
// The average chewing cycle: each half of each cycle at 50 equal shares of its time.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace condyle::host {

struct AnalysedCycle;
struct JawPath;
struct SharedErrors;

/// A mean over cycles of the incisor in the head frame (X anterior, Y left, Z up).
struct AverageCycle {
  static constexpr int kHalf = 50;  ///< points of the opening, then as many of the closing

  struct Point {
    bool is_closing;
    double share;   ///< of the half's time, 0 to 1
    double time_s;  ///< from the closed instant, with mean opening and closing times
    Eigen::Vector3d mean_mm;
    Eigen::Vector3d sd_mm;             ///< between cycles
    Eigen::Vector3d half_interval_mm;  ///< 95 %, of the mean of the subject's cycles
  };

  std::string side;  ///< all, left, right or midline
  int cycles = 0;
  double opening_s = 0, closing_s = 0;  ///< mean times
  std::vector<Point> points;            ///< empty if withheld
  std::string withheld;                 ///< why; empty: it is known
  /// What the first of its cycles with unused samples assumes about them; empty if there is none.
  std::string assumed;
};

/// The averages of `cycles` that are taken: of all, then of each side that occurs. The interval
/// combines their scatter (Student's t) and the errors that all share. Withheld with fewer than
/// five cycles, or if it is wider than +-3 mm somewhere.
std::vector<AverageCycle> average_cycles(const JawPath& path,
                                         const std::vector<AnalysedCycle>& cycles,
                                         const SharedErrors& errors);

}  // namespace condyle::host
