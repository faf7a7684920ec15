// SPDX-License-Identifier: Apache-2.0
// Readings of the kinematic jaw against its truth, which shares no code with them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "condyle/estimator/pose/rotation_vector.h"
#include "readings/condyle_readings.h"
#include "readings/path_measures.h"
#include "readings/simulated_readings.h"
#include "readings/smoothness.h"
#include "readings/stroke_readings.h"
#include "readings/uncertainty.h"
#include "support/acceptance.h"
#include "support/tier.h"

namespace condyle::host {
namespace {

constexpr JawTaskKind kKinds[] = {JawTaskKind::rest, JawTaskKind::opening, JawTaskKind::protrusion,
                                  JawTaskKind::left, JawTaskKind::right,   JawTaskKind::chewing};

JawScenario session(double rate_Hz, double noise_m, double noise_rad, double landmark_sd_mm) {
  JawScenario scenario;
  for (const JawTaskKind kind : kKinds) scenario.tasks.push_back(default_task(kind));
  scenario.tasks.back().chewing.alternates = true;
  scenario.tasks.back().chewing.reversed_share = 0.2;
  scenario.facebow.rate_Hz = rate_Hz;
  scenario.facebow.noise_m = noise_m;
  scenario.facebow.noise_rad = noise_rad;
  scenario.landmarks = {landmark_sd_mm, landmark_sd_mm, landmark_sd_mm};
  return scenario;
}

Analysis analyse_simulation(const KinematicSimulation& simulation, const LandmarkErrors& errors,
                            MovingBody moving = MovingBody::lower) {
  SampleRecording recording(simulation.samples());
  AnalysisChoice choice;
  choice.tasks = stated_tasks(simulation);
  choice.moving = moving;
  return analyse(recording, "simulation", stated_landmarks(simulation, errors), choice);
}

// The formulas on exact poses, of condyles that differ.
TEST(StrokeReadings, EqualTheTruthOnExactPoses) {
  JawScenario scenario = session(200, 0, 0, 0);
  scenario.anatomy.left = {50, 0.03, 0.6, 6};
  scenario.anatomy.right = {55, 0.035, 0.3, 10};
  const KinematicJaw jaw(scenario);
  std::map<std::string, double> truth;
  for (const TrueReading& reading : true_readings(jaw)) {
    truth[fmt::format("{}/{}/{}/{}", reading.task, reading.side, reading.reading, reading.stroke)] =
        reading.value;
  }
  std::set<std::string_view> compared;
  for (const JawStroke& stroke : jaw.motion().strokes()) {
    const JawPath path = exact_path(jaw, stroke.begin_s - 0.1, stroke.end_s + 0.1);
    const TaskKind kind = task_kind(jaw_task_name(stroke.kind), "simulation");
    const auto names = readings_of_stroke(kind, true);
    std::vector<double> values;
    read_stroke(kind, true, path, values, nullptr);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string_view name = names[i].name;
      const std::string key =
          fmt::format("{}/{}/{}/{}", name_of(kind), name_of(names[i].side), name, stroke.stroke);
      const auto expected = truth.find(key);
      if (expected == truth.end()) continue;
      compared.insert(name);
      // Relative to the reading's size. The jerk has steps between samples, where its differences
      // are of first order.
      const double tolerance = name.ends_with("ldlj") ? 4e-6 : 1e-6;
      EXPECT_NEAR(values[i], expected->second,
                  tolerance * std::max(1.0, std::abs(expected->second)))
          << key;
    }
  }
  EXPECT_GE(compared.size(), 40U);
}

// A stroke out in two parts of 6 mm with a stop between them, and back in one.
TEST(StrokeReadings, AStopOnTheWayIsNotSmooth) {
  constexpr double kStep_s = 5e-4, kPart_s = 0.4, kPart_m = 6e-3;
  const auto sparc_with = [&](double stop_s) {
    JawPath path;
    std::vector<double> speeds;
    const auto add = [&](double travel_m, double rate_m_s) {
      path.time_s.push_back(static_cast<double>(path.time_s.size()) * kStep_s);
      for (auto* points : {&path.incisor_m, &path.condyle_m[0], &path.condyle_m[1]}) {
        points->push_back(travel_m * Eigen::Vector3d::UnitX());
      }
      for (auto* rates : {&path.incisor_m_s, &path.condyle_m_s[0], &path.condyle_m_s[1]}) {
        rates->push_back(rate_m_s * Eigen::Vector3d::UnitX());
      }
      path.rotation_rad.emplace_back(0, 0, 0);
      path.turning_rad_s.emplace_back(0, 0, 0);
      path.middle_m.push_back(travel_m * Eigen::Vector3d::UnitX());
    };
    const auto move = [&](double from_m, double by_m) {
      for (double u = 0; u < 1; u += kStep_s / kPart_s) {
        const double rate_m_s = 30 * by_m / kPart_s * u * u * (1 - u) * (1 - u);
        add(from_m + by_m * u * u * u * (10 - 15 * u + 6 * u * u), rate_m_s);
        if (by_m > 0) speeds.push_back(rate_m_s);
      }
    };
    move(0, kPart_m);
    for (double t = 0; t < stop_s; t += kStep_s) {
      add(kPart_m, 0);
      speeds.push_back(0);
    }
    move(kPart_m, kPart_m);
    move(2 * kPart_m, -2 * kPart_m);
    std::vector<double> values;
    read_stroke(TaskKind::protrusion, true, path, values, nullptr);
    const auto names = readings_of_stroke(TaskKind::protrusion, true);
    // What is above 5 % of the peak, and what lies between.
    const double least_m_s = 0.05 * 1.875 * kPart_m / kPart_s;
    while (speeds.front() < least_m_s) speeds.erase(speeds.begin());
    while (speeds.back() < least_m_s) speeds.pop_back();
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].name == "sparc") {
        EXPECT_NEAR(values[i], spectral_arc_length(speeds, kStep_s), 2e-3) << stop_s << " s";
        return values[i];
      }
    }
    ADD_FAILURE() << "no sparc";
    return 0.0;
  };
  EXPECT_LT(sparc_with(0), -1.8);
  EXPECT_LT(sparc_with(0.1), sparc_with(0));
  EXPECT_LT(sparc_with(0.5), sparc_with(0.1));
}

// Also: no excursion encloses more than the hull.
TEST(BorderReadings, EqualTheTruthOnExactPoses) {
  JawScenario scenario;
  scenario.tasks = {default_task(JawTaskKind::border)};
  const KinematicJaw jaw(scenario);
  std::map<std::string, double> truth, found;
  for (const TrueReading& reading : true_readings(jaw)) truth[reading.reading] = reading.value;
  const JawTaskSpan& task = jaw.motion().tasks()[0];
  const JawPath path = exact_path(jaw, task.begin_s, task.end_s);
  const auto names = readings_of_stroke(TaskKind::border, true);
  std::vector<double> values;
  read_stroke(TaskKind::border, true, path, values, nullptr);
  ASSERT_EQ(values.size(), names.size() + 2);  // shortfalls of displacement and rotation
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name(names[i].name);
    found[name] = values[i];
    // The true hull is that of points 0.1 mm apart, between which the path bulges by up to 1e-4 mm.
    const bool is_hull = name.starts_with("border_area") || name.starts_with("border_volume");
    EXPECT_NEAR(values[i], truth.at(name), (is_hull ? 5e-6 : 1e-6) * values[i]) << name;
  }
  for (const char* plane : {"sagittal", "frontal", "horizontal"}) {
    const double loop_mm2 = found.at(fmt::format("border_loop_{}_mm2", plane));
    EXPECT_GT(loop_mm2, 5) << plane;
    EXPECT_LE(loop_mm2, found.at(fmt::format("border_area_{}_mm2", plane))) << plane;
  }
}

// A condyle that goes out along one line and comes back along another.
TEST(CondyleReadings, SeparationIsThatOfTwoKnownLines) {
  constexpr double kTravel_m = 8e-3, kOut_rad = 0.7;
  for (const double apart_rad : {0.05, -0.1, 0.0}) {
    JawPath path;
    for (int i = 0; i <= 4000; ++i) {
      const double share = i / 4000.0;
      const double travel_m = kTravel_m * (1 - std::cos(2 * std::numbers::pi * share)) / 2;
      const double rate_m_s = kTravel_m * std::numbers::pi * std::sin(2 * std::numbers::pi * share);
      const double angle = i <= 2000 ? kOut_rad : kOut_rad + apart_rad;
      const Eigen::Vector3d along(std::cos(angle), 0, -std::sin(angle));
      path.time_s.push_back(share);
      for (auto* points : {&path.incisor_m, &path.condyle_m[0], &path.condyle_m[1]}) {
        points->push_back(travel_m * along);
      }
      for (auto* rates : {&path.incisor_m_s, &path.condyle_m_s[0], &path.condyle_m_s[1]}) {
        rates->push_back(rate_m_s * along);
      }
      path.rotation_rad.emplace_back(0, 0, 0);
      path.turning_rad_s.emplace_back(0, 0, 0);
      path.middle_m.push_back(travel_m * along);
    }
    const auto names = readings_of_stroke(TaskKind::protrusion, true);
    std::vector<double> values;
    read_stroke(TaskKind::protrusion, true, path, values, nullptr);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].name == "condylar_separation_mm") {
        EXPECT_NEAR(values[i], std::abs(0.55 * 8 * apart_rad), 1e-6);
      }
      if (names[i].name == "condylar_peak_speed_mm_s") {
        EXPECT_NEAR(values[i], 8 * std::numbers::pi, 1e-2);
      }
    }
  }
}

// Crossings: sign changes of what noise does not explain.
TEST(CondyleReadings, CountCrossingsThatNoiseDoesNotExplain) {
  const std::vector<StrokeReading> names = {{"condylar_separation_mm", Side::left},
                                            {"condylar_crossing_count", Side::left}};
  const auto count = [&](const std::vector<double>& separations) {
    std::vector<UncertainValue> values(2);
    for (const double separation : separations) {
      UncertainValue value;
      value.value = separation;
      value.noise_sd = 0.1;
      values.push_back(value);
    }
    values.emplace_back().value = 0.7;  // how far the condyle ends from its beginning
    finish_separations(names, values);
    EXPECT_EQ(values.size(), 2U);
    EXPECT_GE(values[0].half_interval(), 0.7);
    return values[1].value;
  };
  EXPECT_EQ(count({0.3, 0.4, 0.5, 0.4, 0.4, 0.3, 0.3, 0.3}), 0);
  EXPECT_EQ(count({0.3, 0.1, -0.1, 0.1, -0.19, 0.1, 0.3, 0.3}), 0);
  EXPECT_EQ(count({0.3, 0.4, 0.1, -0.1, -0.3, -0.4, -0.3, -0.3}), 1);
  EXPECT_EQ(count({0.3, -0.3, -0.3, 0.1, 0.3, 0.4, 0.3, -0.3}), 3);
}

// A shift of 2 mm, known to 1 mm: at 1 mm its direction is known half as well.
TEST(WorkingShift, HasADirectionAsFarAsTheSmallestShiftHasOne) {
  const std::vector<StrokeReading> names = {{"working_shift_mm", Side::left},
                                            {"working_shift_angle_deg", Side::left}};
  const auto angle_of = [&](double half_mm) {
    std::vector<UncertainValue> values(2);
    values[0].value = 2 * std::cos(0.3);
    values[0].doubt = half_mm;
    values[1].value = 0.3 * 180 / std::numbers::pi;
    values[1].noise_sd = 1;
    widen_shift_angle(names, values);
    return values[1];
  };
  EXPECT_NEAR(angle_of(0).half_interval(), kHalf95, 1e-9);
  EXPECT_NEAR(angle_of(1).half_interval(), 2 * kHalf95, 1e-9);
  EXPECT_TRUE(std::isnan(angle_of(2.1).value));
  EXPECT_FALSE(angle_of(2.1).missing.empty());
}

// Without noise what is left is the method's own error.
TEST(Analysis, WithoutNoiseDeviatesByAQuarterOfItsHalfInterval) {
  for (const double rate_Hz : {60.0, 200.0}) {
    const JawScenario scenario = session(rate_Hz, 0, 0, 0);
    const auto jaw = std::make_shared<const KinematicJaw>(scenario);
    const KinematicSimulation simulation(jaw, scenario, 1);
    Coverages coverages;
    // True landmarks, whose stated uncertainty is that of careful work.
    compare_means(analyse_simulation(simulation, {1, 1, 1}), true_readings(*jaw), coverages);
    int compared = 0;
    for (const auto& [key, coverage] : coverages) {
      if (coverage.shown == 0) continue;
      ++compared;
      if (key.ends_with("/cycle_count")) continue;
      // Landmarks hardly matter.
      const bool is_time =
          key.starts_with("chewing/") || key.ends_with("ldlj") || key.ends_with("sparc");
      const double least = 2e-3;
      EXPECT_LE(std::sqrt(coverage.squares), (is_time ? 1 : 0.25) * coverage.halves + least)
          << key << " at " << rate_Hz << " Hz";
    }
    EXPECT_GT(compared, 40);
  }
}

TEST(Analysis, ReadsTheSameWhicheverBodyMoves) {
  JawScenario scenario = session(200, 0, 0, 0);
  const auto jaw = std::make_shared<const KinematicJaw>(scenario);
  const Analysis lower = analyse_simulation({jaw, scenario, 1}, {1, 1, 1});
  scenario.mounting.is_upper = true;
  const Analysis upper = analyse_simulation({jaw, scenario, 1}, {1, 1, 1}, MovingBody::upper);
  ASSERT_EQ(lower.readings.size(), upper.readings.size());
  for (std::size_t i = 0; i < lower.readings.size(); ++i) {
    const JawReading& a = lower.readings[i];
    if (a.provenance == ReadingProvenance::withheld) continue;
    EXPECT_NEAR(a.value, upper.readings[i].value, 0.1 * (a.high - a.low) + 2e-3)
        << name_of(a.task) << " " << a.definition->name;
  }
}

// A quarter of an hour of openings that no jaw makes: the points move, and do not turn.
TEST(Analysis, WithholdsEverythingIfTheRotationIsLost) {
  std::vector<Sample> samples;
  for (int i = 0; i < 900; ++i) {
    Sample sample;
    sample.kind = SampleKind::three_points;
    sample.time_ns = i * 20'000'000LL;
    const double down_m = i < 100 ? 0 : 0.02 * (1 - std::cos((i - 100) * 0.02));
    const double shape[9] = {0, 0, 0, 0.025, 0, 0.03, -0.025, 0, 0.03};
    for (int k = 0; k < 9; ++k) sample.coordinates[k] = shape[k] - (k % 3 == 1 ? down_m : 0);
    samples.push_back(sample);
  }
  SampleRecording recording(samples);
  const Analysis analysis = analyse(recording, "lost", std::nullopt, {});
  EXPECT_FALSE(analysis.unusable.empty());
  EXPECT_FALSE(analysis.readings.empty());
  for (const JawReading& reading : analysis.readings) {
    EXPECT_EQ(reading.provenance, ReadingProvenance::withheld);
    EXPECT_FALSE(reading.reason.empty());
  }
}

struct Cell {
  const char* name;
  double rate_Hz, noise_m, noise_rad;
};
void PrintTo(const Cell& cell, std::ostream* out) {
  *out << cell.name;
}

class ReadingCoverage : public testing::TestWithParam<Cell> {};

// 95 % intervals over noise, landmarks, plane and reference drawn anew. A reading fails if so few
// are covered that a true 90 % had a probability of 1e-4. All readings together fail if the mean of
// the recordings' shares of covered readings is more than four of its standard deviations below
// 93 % (1e-4 with 60 recordings or more; up to 2 % with the 4 of the tier check). With some
// 160 readings in each of four cells the false-alarm probability of both tests is 6 %, and the
// seeds are fixed.
Coverages check_coverage(const Cell& cell, const JawScenario& scenario, int runs) {
  const auto jaw = std::make_shared<const KinematicJaw>(scenario);
  const auto truth = true_readings(*jaw);
  Coverages coverages;
  double shares = 0, squares = 0;
  for (int run = 0; run < runs; ++run) {
    const KinematicSimulation simulation(jaw, scenario, 100 + static_cast<std::uint64_t>(run));
    const double share =
        compare_means(analyse_simulation(simulation, scenario.landmarks), truth, coverages);
    shares += share;
    squares += share * share;
  }
  const double mean = shares / runs;
  const double sd = std::sqrt(std::max(squares / runs - mean * mean, 0.0) / (runs - 1));
  std::printf("%s: %.2f +- %.2f %% of all intervals hold\n", cell.name, 100 * mean, 100 * sd);
  EXPECT_GE(mean, 0.93 - 4 * sd);
  std::printf("%s: reading, shown, covered, rms error, mean half interval\n", cell.name);
  for (const auto& [key, coverage] : coverages) {
    if (coverage.shown == 0) continue;
    std::printf("  %-52s %4d of %d  %5.1f %%  %8.4f  %8.4f\n", key.c_str(), coverage.shown,
                coverage.wanted, 100.0 * coverage.covered / coverage.shown,
                std::sqrt(coverage.squares / coverage.shown), coverage.halves / coverage.shown);
    EXPECT_GE(static_cast<std::uint64_t>(coverage.covered),
              testing_support::fewest_hits(static_cast<std::uint64_t>(coverage.shown), 0.90, 1e-4))
        << key;
  }
  return coverages;
}

TEST_P(ReadingCoverage, IsThatOfTheInterval) {
  const Cell& cell = GetParam();
  const int runs = testing_support::runs(4, 60, 2000);
  const Coverages coverages =
      check_coverage(cell, session(cell.rate_Hz, cell.noise_m, cell.noise_rad, 1), runs);
  EXPECT_EQ(coverages.at("chewing//cycle_count").covered, runs);
  EXPECT_EQ(coverages.at("opening//opening_mm").shown, runs);
}

TEST_P(ReadingCoverage, OfBorderMovements) {
  const Cell& cell = GetParam();
  const int runs = testing_support::runs(4, 60, 2000);
  JawScenario scenario = session(cell.rate_Hz, cell.noise_m, cell.noise_rad, 1);
  scenario.tasks = {default_task(JawTaskKind::rest), default_task(JawTaskKind::border)};
  const Coverages coverages = check_coverage(cell, scenario, runs);
  for (const char* reading : {"border_volume_mm3", "border_area_frontal_mm2"}) {
    EXPECT_EQ(coverages.at(coverage_key("border", "", reading)).shown, runs) << reading;
  }
}

INSTANTIATE_TEST_SUITE_P(Cells, ReadingCoverage,
                         testing::Values(Cell{"fine60", 60, kFineNoise_m, kFineNoise_rad},
                                         Cell{"fine200", 200, kFineNoise_m, kFineNoise_rad},
                                         Cell{"coarse60", 60, kCoarseNoise_m, kCoarseNoise_rad},
                                         Cell{"coarse200", 200, kCoarseNoise_m, kCoarseNoise_rad}),
                         [](const testing::TestParamInfo<Cell>& cell) {
                           return std::string(cell.param.name);
                         });

}  // namespace
}  // namespace condyle::host
