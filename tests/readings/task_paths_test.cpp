// SPDX-License-Identifier: Apache-2.0
// The paths of tasks in a report's drawings: few points, and short tasks whole beside long ones.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "report/plane_drawing.h"

namespace condyle::host {
namespace {

constexpr std::size_t kMostPoints = 8'000, kMostPieces = 12;

// Tasks one after another; the x of each sample is its number.
Analysis analysis_of(double rate_Hz, const std::vector<double>& lengths_s) {
  Analysis analysis;
  analysis.rate_Hz = rate_Hz;
  double end_s = 0;
  for (const double length_s : lengths_s) {
    Task task;
    task.begin_s = end_s;
    task.end_s = end_s += length_s;
    analysis.tasks.push_back(task);
  }
  for (std::size_t k = 0; static_cast<double>(k) <= end_s * rate_Hz; ++k) {
    analysis.path.time_s.push_back(static_cast<double>(k) / rate_Hz);
    analysis.path.incisor_m.emplace_back(static_cast<double>(k), 0, 0);
  }
  return analysis;
}

TEST(TaskPaths, AreWholeWhereTheyAreShortAndFewPointsInAll) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform;
  std::size_t whole = 0, in_pieces = 0;
  for (int run = 0; run < 60; ++run) {
    std::vector<double> lengths_s;
    const std::size_t count = 1 + generator() % 10;
    for (std::size_t i = 0; i < count; ++i) lengths_s.push_back(std::exp(6 * uniform(generator)));
    const Analysis analysis = analysis_of(20 + 180 * uniform(generator), lengths_s);
    const double stride = std::max(1.0, std::floor(analysis.rate_Hz / 50));
    const auto paths = task_paths(analysis, analysis.path.incisor_m);
    ASSERT_EQ(paths.size(), count);
    std::size_t all = 0;
    for (std::size_t i = 0; i < count; ++i) {
      std::size_t points = 0;
      double before = -1;
      for (const auto& piece : paths[i].pieces_m) {
        points += piece.size();
        for (std::size_t k = 0; k < piece.size(); ++k) {
          EXPECT_GT(piece[k].x(), before);
          before = piece[k].x();
          EXPECT_TRUE(k == 0 || piece[k].x() - piece[k - 1].x() == stride);
        }
      }
      const double drawable = lengths_s[i] * analysis.rate_Hz / stride;
      if (drawable < static_cast<double>(kMostPoints / count)) {
        EXPECT_EQ(paths[i].pieces_m.size(), 1U);
        EXPECT_NEAR(static_cast<double>(points), drawable, 2);
      }
      ++(paths[i].pieces_m.size() == 1 ? whole : in_pieces);
      all += points;
    }
    EXPECT_LE(all, kMostPoints + kMostPieces * count);
  }
  EXPECT_GT(whole, 20U);
  EXPECT_GT(in_pieces, 20U);
}

}  // namespace
}  // namespace condyle::host
