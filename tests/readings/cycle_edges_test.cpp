// SPDX-License-Identifier: Apache-2.0
// Chewing cycles at the ends of a task, and beside pauses.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "readings/chewing_cycles.h"
#include "readings/simulated_readings.h"

namespace condyle::host {
namespace {

constexpr double kStep_s = 0.005;

// Heights of a jaw that opens and closes.
struct Chewing {
  std::vector<double> time_s, height_m;

  void rest(double duration_s) {
    for (double t = 0; t < duration_s; t += kStep_s) add(0);
  }
  // As a cosine.
  void cycle(double duration_s, double height_mm) {
    const int steps = static_cast<int>(std::lround(duration_s / kStep_s));
    for (int k = 0; k < steps; ++k) {
      add(-5e-4 * height_mm * (1 - std::cos(2 * std::numbers::pi * k / steps)));
    }
  }
  // Out and back, each with least jerk.
  void cycle_of_halves(double out_s, double back_s, double height_mm) {
    for (const auto& [duration_s, is_back] : {std::pair{out_s, false}, {back_s, true}}) {
      for (double t = 0; t < duration_s - 1e-9; t += kStep_s) {
        const double u = is_back ? 1 - t / duration_s : t / duration_s;
        add(-1e-3 * height_mm * u * u * u * (10 - 15 * u + 6 * u * u));
      }
    }
  }
  void add(double height) {
    time_s.push_back(static_cast<double>(time_s.size()) * kStep_s);
    height_m.push_back(height);
  }
  std::vector<ChewingCycle> cycles(std::size_t begin, std::size_t end) const {
    return find_cycles(time_s, height_m, 0.01e-3, {begin, end});
  }
  std::vector<ChewingCycle> cycles() const { return cycles(0, time_s.size()); }
};

// Wherever a task begins or ends in chewing, its cycles are those that lie within it.
TEST(CyclesOfATask, AreThoseThatLieWithinIt) {
  constexpr int kCycles = 8;
  for (const double duration_s : {0.4, 0.8, 1.6, 2.8}) {
    for (const double height_mm : {3.0, 10.0, 25.0}) {
      Chewing chewing;
      chewing.rest(1);
      chewing.cycle(duration_s, height_mm);
      const std::size_t first = chewing.time_s.size();
      for (int i = 0; i < kCycles; ++i) chewing.cycle(duration_s, height_mm);
      const std::size_t last = chewing.time_s.size();
      chewing.cycle(duration_s, height_mm);
      chewing.rest(1);
      const double steps = duration_s / kStep_s;
      for (int part = 0; part < 40; ++part) {
        // Between the first and second closed instant, and as far from the end.
        const auto cut = static_cast<std::size_t>(std::lround((part + 0.5) / 40 * steps));
        const auto cycles = chewing.cycles(first + cut, last - cut);
        std::vector<ChewingCycle> taken;
        for (const ChewingCycle& cycle : cycles) {
          if (cycle.rejected.empty()) taken.push_back(cycle);
        }
        ASSERT_EQ(taken.size(), kCycles - 2U)
            << duration_s << " s, " << height_mm << " mm, " << cut;
        for (std::size_t i = 0; i < taken.size(); ++i) {
          const double begin_s = chewing.time_s[first] + static_cast<double>(i + 1) * duration_s;
          ASSERT_NEAR(taken[i].begin_s, begin_s, 0.02 * duration_s) << cut;
          ASSERT_NEAR(taken[i].end_s, begin_s + duration_s, 0.02 * duration_s) << cut;
        }
      }
    }
  }
}

TEST(CyclesOfATask, ThatBeginsAtRestAreAll) {
  for (const double rest_s : {0.0, 0.1, 0.3, 1.0}) {
    Chewing chewing;
    chewing.rest(1.5);
    const std::size_t first = chewing.time_s.size();
    for (int i = 0; i < 5; ++i) chewing.cycle(0.8, 15);
    const std::size_t last = chewing.time_s.size();
    chewing.rest(1.5);
    const auto margin = static_cast<std::size_t>(rest_s / kStep_s);
    const auto cycles = chewing.cycles(first - margin, last + margin);
    ASSERT_EQ(cycles.size(), 5U) << rest_s;
    for (const ChewingCycle& cycle : cycles) EXPECT_EQ(cycle.rejected, "") << rest_s;
  }
}

TEST(CyclesOfATask, AreNotTakenWhereTheRecordingBeginsOrEndsWithinThem) {
  Chewing chewing;
  for (int i = 0; i < 6; ++i) chewing.cycle(0.8, 15);
  const std::size_t end = chewing.time_s.size();
  for (std::size_t cut = 20; cut < 140; cut += 5) {
    Chewing part;
    for (std::size_t k = cut; k < end - cut; ++k) part.add(chewing.height_m[k]);
    int taken = 0;
    for (const ChewingCycle& cycle : part.cycles()) taken += cycle.rejected.empty();
    EXPECT_EQ(taken, 4) << cut;
  }
}

// Who closes fast and opens slowly is closed at the turn, not in the middle of the time near it.
TEST(CyclesOfATask, BeginWhereTheJawTurnsHoweverFastItCloses) {
  for (const double back_s : {0.2, 0.3, 0.6, 0.9}) {
    Chewing chewing;
    chewing.rest(2);
    double at_s = chewing.time_s.back() + kStep_s;
    for (int i = 0; i < 6; ++i) chewing.cycle_of_halves(0.4, back_s, 15);
    chewing.rest(2);
    const auto cycles = chewing.cycles();
    ASSERT_EQ(cycles.size(), 6U);
    for (const ChewingCycle& cycle : cycles) {
      if (!cycle.begins.is_pause) {
        EXPECT_NEAR(cycle.begin_s, at_s, 0.005) << back_s;
      }
      at_s += 0.4 + back_s;
      if (!cycle.ends.is_pause) {
        EXPECT_NEAR(cycle.end_s, at_s, 0.005) << back_s;
      }
    }
  }
}

// Who is closed as long after each cycle chews so slowly; a longer pause belongs to no cycle.
TEST(Pauses, ThatFollowEachCycleBelongToThem) {
  for (double pause_s = 0; pause_s < 1.2; pause_s += 0.05) {
    Chewing chewing;
    chewing.rest(2);
    for (int i = 0; i < 10; ++i) {
      chewing.cycle(0.7, 15);
      chewing.rest(i == 4 ? 2.6 : pause_s);
    }
    chewing.rest(2);
    double sum_s = 0;
    int count = 0;
    for (const ChewingCycle& cycle : chewing.cycles()) {
      if (!cycle.rejected.empty() || cycle.begins.is_pause || cycle.ends.is_pause) continue;
      sum_s += cycle.end_s - cycle.begin_s;
      ++count;
    }
    ASSERT_EQ(count, 6) << pause_s;
    EXPECT_NEAR(sum_s / count, 0.7 + pause_s, 0.02) << pause_s;
  }
}

// A movement that arrives slowly has no instant of arrival: the doubt says so.
TEST(Pauses, ThatBeginSlowlyBeginAtAnUncertainTime) {
  const auto doubt_s = [](double slow_mm, double slow_s) {
    Chewing chewing;
    chewing.rest(2);
    for (int i = 0; i < 3; ++i) chewing.cycle(0.8, 15);
    const std::size_t end = chewing.time_s.size();
    // The last rise stops `slow_mm` below the top, which it reaches after `slow_s`.
    for (std::size_t k = end - 40; k < end; ++k) {
      chewing.height_m[k] = std::min(chewing.height_m[k], -1e-3 * slow_mm);
    }
    for (double t = 0; t < slow_s; t += kStep_s) chewing.add(-1e-3 * slow_mm * (1 - t / slow_s));
    chewing.rest(2);
    return chewing.cycles().back().ends.sd_s;
  };
  EXPECT_LT(doubt_s(0, 0), 0.03);
  EXPECT_GT(doubt_s(0.8, 0.3), 0.06);
  EXPECT_GT(doubt_s(0.8, 0.6), doubt_s(0.8, 0.3));
}

// One with no or few samples of the task: withheld, with the reason.
TEST(ChewingTask, WithoutSamplesIsWithheld) {
  JawScenario scenario;
  for (const JawTaskKind kind : {JawTaskKind::rest, JawTaskKind::chewing}) {
    scenario.tasks.push_back(default_task(kind));
  }
  const KinematicSimulation simulation(scenario, 1);
  std::vector<Sample> samples;
  const double gap_s = 8;
  for (const Sample& sample : simulation.samples()) {
    if (std::abs(seconds(sample.time_ns) - gap_s) > 1) samples.push_back(sample);
  }
  for (const double length_s : {0.001, 0.02, 0.5, 1.5}) {
    for (const TaskKind kind : {TaskKind::chewing, TaskKind::opening, TaskKind::border}) {
      SampleRecording recording(samples);
      AnalysisChoice choice;
      choice.tasks = {Task{kind, gap_s - length_s / 2, gap_s + length_s / 2, false, Side::none}};
      const Analysis analysis =
          analyse(recording, "a gap", stated_landmarks(simulation, {1, 1, 1}), choice);
      for (const JawReading& reading : analysis.readings) {
        if (reading.task != kind || reading.definition->name.ends_with("_count")) continue;
        EXPECT_EQ(reading.provenance, ReadingProvenance::withheld) << reading.definition->name;
        EXPECT_FALSE(reading.reason.empty()) << reading.definition->name;
      }
    }
  }
}

}  // namespace
}  // namespace condyle::host
