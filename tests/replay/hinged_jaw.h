// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "support/command.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle::testing_support {

/// A jaw that turns about a hinge: followed at the hinge it stands still, whatever its points do.
class HingedJaw : public testing::Test {
 protected:
  // The turn from the closed jaw about x, and its rate.
  static double angle_rad(double time_s) { return 0.15 * (1 - std::cos(2 * M_PI * time_s)); }
  static double rate_rad_s(double time_s) { return 0.15 * 2 * M_PI * std::sin(2 * M_PI * time_s); }
  // `change(i, points)` may spoil the nine coordinates (mm) of sample i.
  template <class Change>
  std::string write(const Change& change) {
    std::string rows =
        "time_s,p1_x_mm,p1_y_mm,p1_z_mm,p2_x_mm,p2_y_mm,p2_z_mm,p3_x_mm,p3_y_mm,p3_z_mm\n";
    std::mt19937 generator(3);
    std::normal_distribution<double> noise(0, 0.005);
    // Points about a hinge at (0, 0, 0) mm, parallel to x; the bite fork's own frame is at point 1.
    const double shape[3][3] = {{0, -80, -40}, {25, -80, -10}, {-25, -80, -10}};
    for (int i = 0; i < 600; ++i) {
      const double angle = angle_rad(i / 60.0);
      double points[9];
      const double common[3] = {noise(generator), noise(generator), noise(generator)};
      for (int k = 0; k < 3; ++k) {
        points[3 * k] = shape[k][0] + common[0];
        points[3 * k + 1] =
            shape[k][1] * std::cos(angle) - shape[k][2] * std::sin(angle) + common[1];
        points[3 * k + 2] =
            shape[k][1] * std::sin(angle) + shape[k][2] * std::cos(angle) + common[2];
      }
      change(i, points);
      rows += std::to_string(i / 60.0);
      for (const double value : points) rows += "," + std::to_string(value);
      rows += "\n";
    }
    return folder_.write("points.csv", rows);
  }
  Table replay(const std::string& recording, std::vector<std::string> more) {
    more.insert(more.begin(), {"replay", recording, "--out", folder_ / "e.csv"});
    const CommandResult result = run_condyle(more);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    summary_ = result.output;
    return read_table(folder_ / "e.csv");
  }
  static double largest(const Table& table, const char* column) {
    double largest = 0;
    for (const double value : table.numbers(column)) largest = std::max(largest, std::abs(value));
    return largest;
  }

  TemporaryFolder folder_;
  std::string summary_;
};

}  // namespace condyle::testing_support
