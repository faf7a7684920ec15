// SPDX-License-Identifier: Apache-2.0
// Readings do not depend on the instrument's frame, and a mirrored subject has mirrored readings.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "readings/simulated_bodies.h"
#include "readings/simulated_readings.h"
#include "support/tier.h"

namespace condyle::host {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

struct Noise {
  const char* name;
  double m, rad;
};
constexpr Noise kNone{"none", 0, 0}, kFine{"fine", kFineNoise_m, kFineNoise_rad},
    kCoarse{"coarse", kCoarseNoise_m, kCoarseNoise_rad};

// What an instrument recorded, and what is stated with it.
struct Recorded {
  std::vector<Sample> samples;
  Landmarks landmarks;
  AnalysisChoice choice;

  explicit Recorded(const Noise& noise) {
    JawScenario scenario;
    for (const JawTaskKind kind :
         {JawTaskKind::rest, JawTaskKind::opening, JawTaskKind::protrusion, JawTaskKind::left,
          JawTaskKind::right, JawTaskKind::border, JawTaskKind::chewing}) {
      scenario.tasks.push_back(default_task(kind));
      scenario.tasks.back().strokes = std::min(scenario.tasks.back().strokes, 2);
    }
    scenario.tasks.back().duration_s = 6;
    scenario.anatomy.left = {50, 0.03, 0.6, 6};
    scenario.anatomy.right = {55, 0.035, 0.3, 10};
    scenario.facebow.rate_Hz = 60;
    scenario.facebow.noise_m = noise.m;
    scenario.facebow.noise_rad = noise.rad;
    const KinematicSimulation simulation(scenario, 5);
    samples = simulation.samples();
    // Also of each point, so that the body's shape has to be learned.
    RandomGenerator random(7);
    for (Sample& sample : samples) {
      for (double& coordinate : sample.coordinates) coordinate += noise.m * random.normal();
    }
    landmarks = stated_landmarks(simulation, {1, 1, 1});
    choice.tasks = stated_tasks(simulation);
  }

  // Every point p becomes motion p.
  template <class Motion>
  Recorded moved(const Motion& motion) const {
    Recorded result = *this;
    for (Sample& sample : result.samples) {
      for (int point = 0; point < 3; ++point) {
        Eigen::Map<Vector3d> place(sample.coordinates + 3 * point);
        place = Vector3d(motion * Vector3d(place));
      }
    }
    for (Vector3d& point : result.landmarks.point_m) point = Vector3d(motion * point);
    return result;
  }

  Analysis analysis() const {
    SampleRecording recording(samples);
    return analyse(recording, "simulation", landmarks, choice);
  }
  // The same with the points as a body of any number of named ones.
  Analysis analysis_of_named_points() const {
    NamedPoints points;
    points.names = {"A", "B", "C"};
    for (const Sample& sample : samples) {
      points.time_s.push_back(seconds(sample.time_ns));
      points.points_m.emplace_back(Eigen::Map<const Eigen::Matrix3d>(sample.coordinates));
    }
    PointRecording recording(points);
    AnalysisChoice named = choice;
    named.bodies.jaw = points.names;
    return analyse(recording, "simulation", landmarks, named);
  }
};

Isometry3d random_frame(RandomGenerator& random) {
  const double angle_rad = std::numbers::pi * random.uniform();
  return rigid_motion(angle_rad * random_vector(random).normalized(),
                      random.uniform() * random_vector(random).normalized());
}

// Without noise within 1e-9; with noise within this share of the half interval.
constexpr double kShare = 1e-6;
void expect_same(const Analysis& one, const Analysis& other, bool is_noisy) {
  ASSERT_EQ(one.readings.size(), other.readings.size());
  int shown = 0;
  for (std::size_t i = 0; i < one.readings.size(); ++i) {
    const JawReading& a = one.readings[i];
    const JawReading& b = other.readings[i];
    const std::string name =
        fmt::format("{} {} {} {}", name_of(a.task), name_of(a.side), a.definition->name, a.stroke);
    ASSERT_EQ(a.definition, b.definition) << name;
    ASSERT_EQ(a.provenance, b.provenance) << name;
    if (a.provenance == ReadingProvenance::withheld) continue;
    ++shown;
    const double tolerance = is_noisy ? kShare * (a.high - a.low) / 2 + 1e-9 : 1e-9;
    EXPECT_NEAR(a.value, b.value, tolerance) << name << " half " << (a.high - a.low) / 2;
  }
  EXPECT_GT(shown, 100);
}

class ReadingFrames : public testing::TestWithParam<Noise> {};

TEST_P(ReadingFrames, OfTheInstrumentDoNotMatter) {
  const Noise& noise = GetParam();
  const Recorded recorded(noise);
  const Analysis straight = recorded.analysis();
  RandomGenerator random(11);
  for (int run = 0; run < testing_support::runs(2, 8, 100); ++run) {
    SCOPED_TRACE(run);
    expect_same(straight, recorded.moved(random_frame(random)).analysis(), noise.m > 0);
  }
}

TEST_P(ReadingFrames, DoNotMatterToNamedPoints) {
  const Noise& noise = GetParam();
  const Recorded recorded(noise);
  const Analysis straight = recorded.analysis_of_named_points();
  RandomGenerator random(12);
  for (int run = 0; run < testing_support::runs(1, 4, 50); ++run) {
    SCOPED_TRACE(run);
    expect_same(straight, recorded.moved(random_frame(random)).analysis_of_named_points(),
                noise.m > 0);
  }
}

// Mirrored at the midsagittal plane, with the names of the sides exchanged.
Recorded mirrored(const Recorded& recorded) {
  const Isometry3d head = head_frame(recorded.landmarks);
  const Eigen::Affine3d mirror =
      head * Eigen::Affine3d(Eigen::Scaling(1.0, -1.0, 1.0)) * head.inverse();
  Recorded result = recorded.moved(mirror);
  auto& point_m = result.landmarks.point_m;
  std::swap(point_m[Landmarks::condyle_left], point_m[Landmarks::condyle_right]);
  std::swap(point_m[Landmarks::plane_left], point_m[Landmarks::plane_right]);
  for (Task& task : result.choice.tasks) {
    if (task.kind == TaskKind::left || task.kind == TaskKind::right) {
      task.kind = task.kind == TaskKind::left ? TaskKind::right : TaskKind::left;
    }
  }
  return result;
}

using ReadingKey = std::tuple<TaskKind, Side, std::string_view, int>;
std::map<ReadingKey, JawReading> table_of(const Analysis& analysis) {
  std::map<ReadingKey, JawReading> table;
  for (const JawReading& one : analysis.readings) {
    const ReadingKey key{one.task, one.side, one.definition->name, one.stroke};
    EXPECT_TRUE(table.emplace(key, one).second) << one.definition->name;
  }
  return table;
}

TEST_P(ReadingFrames, AMirrorExchangesLeftAndRight) {
  const Noise& noise = GetParam();
  const Recorded recorded(noise);
  const auto straight = table_of(recorded.analysis());
  const auto mirror = table_of(mirrored(recorded).analysis());
  ASSERT_EQ(straight.size(), mirror.size());
  int shown = 0;
  for (const auto& [key, a] : straight) {
    const auto& [task, side, name, stroke] = key;
    const TaskKind other_task = task == TaskKind::left    ? TaskKind::right
                                : task == TaskKind::right ? TaskKind::left
                                                          : task;
    const Side other_side = side == Side::left    ? Side::right
                            : side == Side::right ? Side::left
                                                  : side;
    const auto found = mirror.find({other_task, other_side, name, stroke});
    const std::string what = fmt::format("{} {} {} {}", name_of(task), name_of(side), name, stroke);
    ASSERT_NE(found, mirror.end()) << what;
    const JawReading& b = found->second;
    ASSERT_EQ(a.provenance, b.provenance) << what << a.reason << b.reason;
    if (a.provenance == ReadingProvenance::withheld) continue;
    ++shown;
    const bool is_signed = name == "opening_deflection_mm" || name == "opening_deviation_mm" ||
                           name == "laterality_index" || name.ends_with("_difference_mm");
    const double half = (a.high - a.low) / 2;
    const double off = std::abs(a.value - (is_signed ? -b.value : b.value));
    EXPECT_LE(off, noise.m > 0 ? kShare * half + 1e-9 : 1e-9) << what << " half " << half;
  }
  EXPECT_GT(shown, 100);
}

INSTANTIATE_TEST_SUITE_P(Noise, ReadingFrames, testing::Values(kNone, kFine, kCoarse),
                         [](const testing::TestParamInfo<Noise>& noise) {
                           return std::string(noise.param.name);
                         });

}  // namespace
}  // namespace condyle::host
