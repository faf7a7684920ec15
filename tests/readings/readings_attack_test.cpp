// SPDX-License-Identifier: Apache-2.0
// What an attack on the analysis found: recordings that are not what they seem. No reading may be
// shown and clearly wrong.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "hosted/files/input_error.h"
#include "readings/simulated_readings.h"

namespace condyle::host {
namespace {

class AttackedReadings : public testing::Test {
 protected:
  AttackedReadings() {
    for (const JawTaskKind kind : {JawTaskKind::rest, JawTaskKind::opening, JawTaskKind::left}) {
      scenario_.tasks.push_back(default_task(kind));
    }
    scenario_.facebow.rate_Hz = 100;
    scenario_.facebow.noise_m = kFineNoise_m;
    scenario_.facebow.noise_rad = kFineNoise_rad;
    simulation_ = std::make_unique<KinematicSimulation>(scenario_, 3);
    samples_ = simulation_->samples();
    choice_.tasks = stated_tasks(*simulation_);
  }

  Analysis analyse_samples() const {
    SampleRecording recording(samples_);
    return analyse(recording, "attacked", stated_landmarks(*simulation_, {0.5, 0.5, 0.5}), choice_);
  }
  // Readings that are shown and further from the truth than twice their half interval.
  std::vector<std::string> clearly_wrong(const Analysis& analysis) const {
    Coverages coverages;
    compare_means(analysis, true_readings(simulation_->jaw()), coverages);
    std::vector<std::string> wrong;
    for (const auto& [key, coverage] : coverages) {
      const bool is_compared = !key.ends_with("/displacement_mm") &&
                               !key.ends_with("/rotation_deg") && !key.starts_with("rest/");
      if (is_compared && coverage.shown == 1 && coverage.covered == 0 &&
          std::sqrt(coverage.squares) > 2 * coverage.halves + 0.05) {
        wrong.push_back(key);
      }
    }
    return wrong;
  }
  void move(std::size_t sample, const Eigen::Vector3d& by_m) {
    for (int k = 0; k < 9; ++k) samples_[sample].coordinates[k] += by_m[k % 3];
  }
  std::size_t sample_at(double time_s) const { return static_cast<std::size_t>(time_s * 100); }

  JawScenario scenario_;
  std::unique_ptr<KinematicSimulation> simulation_;
  std::vector<Sample> samples_;
  AnalysisChoice choice_;
};

TEST_F(AttackedReadings, AreRightWithoutAnAttack) {
  EXPECT_TRUE(clearly_wrong(analyse_samples()).empty());
}

TEST_F(AttackedReadings, SpikesAloneAndInPairs) {
  for (const std::size_t gap : {1U, 2U, 3U, 6U}) {
    for (const std::size_t length : {1U, 2U, 3U}) {
      samples_ = simulation_->samples();
      for (const double time_s : {8.0, 9.5, 20.0, 23.0}) {
        const std::size_t first = sample_at(time_s);
        for (std::size_t i = 0; i < length; ++i) {
          move(first + i, {0.004, -0.003, 0.005});
          move(first + length + gap + i, {-0.005, 0.004, 0.003});
        }
      }
      const auto wrong = clearly_wrong(analyse_samples());
      EXPECT_TRUE(wrong.empty()) << "gap " << gap << ", length " << length << ": "
                                 << testing::PrintToString(wrong);
    }
  }
}

TEST_F(AttackedReadings, AForkThatSlips) {
  for (std::size_t i = sample_at(12); i < samples_.size(); ++i) move(i, {0.0007, 0, 0.0007});
  const auto wrong = clearly_wrong(analyse_samples());
  EXPECT_TRUE(wrong.empty()) << wrong[0];
}

TEST_F(AttackedReadings, AStrokeThatTheTaskCuts) {
  for (Task& task : choice_.tasks) {
    if (task.kind == TaskKind::opening) task.end_s = task.begin_s + 1;
  }
  for (const JawReading& reading : analyse_samples().readings) {
    if (reading.task != TaskKind::opening) continue;
    EXPECT_EQ(reading.provenance, ReadingProvenance::withheld) << reading.definition->name;
  }
}

TEST_F(AttackedReadings, ATaskWithTheNameOfAnother) {
  for (Task& task : choice_.tasks) {
    task.kind = task.kind == TaskKind::opening ? TaskKind::protrusion
                : task.kind == TaskKind::left  ? TaskKind::right
                                               : task.kind;
  }
  for (const JawReading& reading : analyse_samples().readings) {
    if (reading.task == TaskKind::rest) continue;
    EXPECT_EQ(reading.provenance, ReadingProvenance::withheld) << reading.definition->name;
  }
}

TEST_F(AttackedReadings, TwoPointsExchanged) {
  for (std::size_t i = samples_.size() / 2; i < samples_.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      std::swap(samples_[i].coordinates[3 + k], samples_[i].coordinates[6 + k]);
    }
  }
  EXPECT_FALSE(analyse_samples().unusable.empty());
}

TEST_F(AttackedReadings, APointThatWandersFromTheOthers) {
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    samples_[i].coordinates[3] += 1e-3 * std::sin(0.002 * static_cast<double>(i));
  }
  const Analysis analysis = analyse_samples();
  EXPECT_TRUE(!analysis.unusable.empty() || clearly_wrong(analysis).empty());
}

TEST_F(AttackedReadings, AReferenceDuringAnOpening) {
  for (const Task& task : choice_.tasks) {
    if (task.kind == TaskKind::opening) {
      choice_.reference_s = {task.begin_s + 0.3, task.begin_s + 1};
    }
  }
  EXPECT_THROW(analyse_samples(), InputError);
}

}  // namespace
}  // namespace condyle::host
