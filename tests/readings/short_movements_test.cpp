// SPDX-License-Identifier: Apache-2.0
// Strokes with movements that are shorter than the smoothing or the means of greatest values: a
// click of 1 mm to the side within a few samples, and a tremor. The intervals have to contain what
// is read of the exact path, or the readings have to be withheld.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "readings/reading_groups.h"
#include "readings/simulated_readings.h"
#include "readings/stroke_readings.h"
#include "support/acceptance.h"
#include "support/tier.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

// Added to a stroke (m), in the head frame; the instrument's frame has the same axes.
using Displacement = std::function<Vector3d(const JawStroke&, double time_s)>;

constexpr LandmarkErrors kErrors{1e-4, 1e-4, 1e-4};
constexpr const char* kGreatestValues[] = {"displacement_mm", "opening_mm", "opening_vertical_mm",
                                           "protrusion_mm", "condylar_translation_mm"};
// With tremor, fewer of these are known.
constexpr const char* kPathsToTop[] = {"condylar_path_mm", "condylar_path_difference_mm"};
constexpr const char* kReadAtTop[] = {"opening_deflection_mm", "helical_axis_x_mm",
                                      "helical_axis_z_mm", "working_shift_mm",
                                      "working_shift_angle_deg"};

double least_jerk(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10 + x * (-15 + 6 * x));
}

// 1 mm to the left within `click_s` on the way out, and slowly back.
Displacement click(double click_s) {
  return [click_s](const JawStroke& stroke, double time_s) -> Vector3d {
    constexpr double kClick_m = 1e-3, kReturn_s = 0.5;
    const double share = 0.3 + 0.1 * stroke.stroke;
    const double from_s = stroke.begin_s + share * (stroke.outward_end_s - stroke.begin_s);
    return {0,
            kClick_m * (least_jerk((time_s - from_s) / click_s) -
                        least_jerk((time_s - stroke.return_begin_s) / kReturn_s)),
            0};
  };
}

// Forward and down, and at once back: on the way out, or where the jaw turns.
Displacement jerk(double amplitude_m, double jerk_s, bool is_at_turn) {
  return [=](const JawStroke& stroke, double time_s) -> Vector3d {
    const double share = is_at_turn ? 1 : 0.3 + 0.1 * stroke.stroke;
    const double since_s =
        time_s - stroke.begin_s - share * (stroke.outward_end_s - stroke.begin_s);
    const double bump = least_jerk(2 * since_s / jerk_s) - least_jerk(2 * since_s / jerk_s - 1);
    return amplitude_m * bump * Vector3d(0.7, 0, -0.7);
  };
}

// Up, forward and to the left, while the jaw is far from where the stroke began.
Displacement tremor(double amplitude_m, double frequency_Hz) {
  return [=](const JawStroke& stroke, double time_s) -> Vector3d {
    const double out =
        least_jerk((time_s - stroke.begin_s) / (stroke.outward_end_s - stroke.begin_s));
    const double back =
        least_jerk((time_s - stroke.return_begin_s) / (stroke.end_s - stroke.return_begin_s));
    const double phase = 2 * std::numbers::pi * frequency_Hz * time_s + stroke.stroke;
    return amplitude_m * (out - back) * std::sin(phase) * Vector3d(0.6, 0.5, 0.6);
  };
}

// To the left while the jaw is farthest, and back on the way in, with a tremor.
Displacement drift(double amplitude_m, double tremor_m) {
  constexpr double kTremor_Hz = 7;
  return [=, trembling = tremor(tremor_m, kTremor_Hz)](const JawStroke& stroke,
                                                       double time_s) -> Vector3d {
    const double hold_s = stroke.return_begin_s - stroke.outward_end_s;
    const double return_s = stroke.end_s - stroke.return_begin_s;
    const double out = least_jerk((time_s - stroke.outward_end_s) / hold_s);
    const double back = least_jerk((time_s - stroke.return_begin_s) / return_s);
    return amplitude_m * (out - back) * Vector3d(0, 1, 0) + trembling(stroke, time_s);
  };
}

KinematicSimulation simulation_of(double rate_Hz, double noise_rad, int run) {
  JawScenario scenario;
  for (const JawTaskKind kind :
       {JawTaskKind::rest, JawTaskKind::opening, JawTaskKind::protrusion, JawTaskKind::left}) {
    scenario.tasks.push_back(default_task(kind));
  }
  scenario.motion_seed = static_cast<std::uint64_t>(run + 1);
  scenario.facebow.rate_Hz = rate_Hz;
  scenario.facebow.noise_m = kFineNoise_m;
  scenario.facebow.noise_rad = noise_rad;
  scenario.landmarks = kErrors;
  return KinematicSimulation(scenario, static_cast<std::uint64_t>(run + 1));
}

Analysis analysis_of(const KinematicSimulation& simulation, const Displacement& displacement) {
  std::vector<Sample> samples = simulation.samples();
  for (Sample& sample : samples) {
    const double time_s = 1e-9 * static_cast<double>(sample.time_ns);
    for (const JawStroke& stroke : simulation.jaw().motion().strokes()) {
      if (time_s < stroke.begin_s || time_s > stroke.end_s) continue;
      const Vector3d moved_m = displacement(stroke, time_s);
      for (int i = 0; i < 9; ++i) {
        sample.coordinates[static_cast<std::size_t>(i)] += moved_m[i % 3];
      }
    }
  }
  SampleRecording recording(samples);
  AnalysisChoice choice;
  choice.tasks = stated_tasks(simulation);
  return analyse(recording, "simulation", stated_landmarks(simulation, kErrors), choice);
}

// The readings of the exact path of a stroke, by side and name.
std::map<std::string, double> truth_of(const KinematicJaw& jaw, const JawStroke& stroke,
                                       TaskKind kind, const Displacement& displacement) {
  constexpr double kStep_s = 1e-5;
  JawPath path = exact_path(jaw, stroke.begin_s, stroke.end_s);
  for (std::size_t k = 0; k < path.time_s.size(); ++k) {
    const double time_s = path.time_s[k];
    const Vector3d moved_m = displacement(stroke, time_s);
    const Vector3d rate_m_s =
        (displacement(stroke, time_s + kStep_s) - displacement(stroke, time_s - kStep_s)) /
        (2 * kStep_s);
    for (auto* points : {&path.incisor_m, &path.condyle_m[0], &path.condyle_m[1], &path.middle_m}) {
      (*points)[k] += moved_m;
    }
    for (auto* rates : {&path.incisor_m_s, &path.condyle_m_s[0], &path.condyle_m_s[1]}) {
      (*rates)[k] += rate_m_s;
    }
  }
  std::vector<double> values;
  read_stroke(kind, true, path, values, nullptr);
  const auto names = readings_of_stroke(kind, true);
  std::map<std::string, double> truth;
  for (std::size_t i = 0; i < names.size(); ++i) {
    truth[std::string(name_of(names[i].side)) + std::string(names[i].name)] = values[i];
  }
  return truth;
}

// Calls `use(reading, truth)` for each reading of a stroke whose truth exists.
template <class Use>
void for_each_stroke(const KinematicSimulation& simulation, const Displacement& displacement,
                     const Analysis& analysis, const Use& use) {
  for (const JawStroke& stroke : simulation.jaw().motion().strokes()) {
    const TaskKind kind = stroke.kind == JawTaskKind::opening      ? TaskKind::opening
                          : stroke.kind == JawTaskKind::protrusion ? TaskKind::protrusion
                                                                   : TaskKind::left;
    const auto truth = truth_of(simulation.jaw(), stroke, kind, displacement);
    for (const JawReading& reading : analysis.readings) {
      if (reading.task != kind || reading.stroke != stroke.stroke) continue;
      const std::string name(reading.definition->name);
      if (name == "condylar_crossing_count") continue;  // which a path without noise has not
      const auto found = truth.find(std::string(name_of(reading.side)) + name);
      if (found == truth.end() || !std::isfinite(found->second)) continue;
      use(reading, found->second);
    }
  }
}

void compare_strokes(const KinematicSimulation& simulation, const Displacement& displacement,
                     Coverages& coverages) {
  const Analysis analysis = analysis_of(simulation, displacement);
  for_each_stroke(simulation, displacement, analysis, [&](const JawReading& reading, double truth) {
    Coverage& coverage = coverages[std::string(reading.definition->name)];
    ++coverage.wanted;
    if (reading.provenance == ReadingProvenance::withheld) return;
    ++coverage.shown;
    coverage.covered += reading.low <= truth && truth <= reading.high;
    coverage.sum += reading.value - truth;
    coverage.halves += (reading.high - reading.low) / 2;
  });
}

void print(const Coverages& coverages) {
  for (const auto& [name, of] : coverages) {
    if (of.shown == 0) continue;
    std::printf("%-36s shown %4d of %4d, covered %5.1f %%, bias %8.4f, half interval %7.4f\n",
                name.c_str(), of.shown, of.wanted, 100.0 * of.covered / of.shown, of.sum / of.shown,
                of.halves / of.shown);
  }
}

// The tier check takes a third of the cells of three factors, in which every level occurs.
bool is_taken(int cell) {
  return testing_support::tier_is_at_least(testing_support::Tier::full) ||
         (cell + cell / 3 + cell / 9) % 3 == 0;
}

TEST(ShortMovements, OfAClickAreInTheIntervalsOrWithheld) {
  const int runs = testing_support::runs(1, 1, 20);
  Coverages coverages;
  int cell = 0;
  for (const double click_s : {0.02, 0.04, 0.08}) {
    for (const double rate_Hz : {100.0, 200.0, 400.0}) {
      for (const double noise_rad : {1e-4, 8e-4}) {
        if (!is_taken(cell++)) continue;
        for (int run = 0; run < runs; ++run) {
          compare_strokes(simulation_of(rate_Hz, noise_rad, run), click(click_s), coverages);
        }
      }
    }
  }
  print(coverages);
  for (const auto& [name, coverage] : coverages) {
    // The strokes of a recording share the errors of its reference position, so that no
    // probability of a false alarm is known. Independent ones at 75 % would fail once in 10,000.
    EXPECT_GE(static_cast<std::uint64_t>(coverage.covered),
              testing_support::fewest_hits(static_cast<std::uint64_t>(coverage.shown), 0.75, 1e-4))
        << name;
  }
  EXPECT_GT(coverages["condylar_path_mm"].wanted, 0);
  // A click may look like samples at which an instrument failed. They are not used, and a path
  // beside them is withheld: 4 of 6,462 in the longest form.
  EXPECT_GE(coverages["condylar_path_mm"].shown, 0.998 * coverages["condylar_path_mm"].wanted);
  EXPECT_GT(coverages["condylar_peak_speed_mm_s"].shown, 0);
}

// Samples that jump away from the path are not used, as if an instrument had failed. The jaw may
// have jumped.
TEST(ShortMovements, OfAJerkAreInTheIntervalsOrWithheld) {
  const int runs = testing_support::runs(1, 1, 20);
  Coverages coverages;
  int cell = 0;
  for (const double amplitude_m : {1e-3, 2e-3, 5e-3}) {
    for (const double jerk_s : {0.025, 0.06, 0.12}) {
      for (const double rate_Hz : {60.0, 100.0, 200.0}) {
        if (!is_taken(cell++)) continue;
        for (int run = 0; run < 2 * runs; ++run) {
          compare_strokes(simulation_of(rate_Hz, 1e-4, run), jerk(amplitude_m, jerk_s, run >= runs),
                          coverages);
        }
      }
    }
  }
  print(coverages);
  for (const auto& [name, coverage] : coverages) {
    if (!is_of_short_movements(name)) continue;
    if (!name.ends_with("ldlj")) {
      EXPECT_GT(coverage.shown, 0.05 * coverage.wanted) << name;
    }
    // As above.
    EXPECT_GE(static_cast<std::uint64_t>(coverage.covered),
              testing_support::fewest_hits(static_cast<std::uint64_t>(coverage.shown), 0.75, 1e-4))
        << name;
  }
}

// A jerk where the jaw turns, of which no sample is used, changes the greatest values. They may
// miss it, but then they are derived.
TEST(ShortMovements, OfAJerkThatIsNotUsedAreNotMeasured) {
  int derived = 0;
  for (const double amplitude_m : {2e-3, 5e-3}) {
    // Slower ones may have no sample near its top.
    for (const double rate_Hz : {100.0, 200.0, 400.0}) {
      SCOPED_TRACE(testing::Message() << rate_Hz << " Hz, " << amplitude_m << " m");
      const Displacement displacement = jerk(amplitude_m, 0.025, true);
      const KinematicSimulation simulation = simulation_of(rate_Hz, 1e-4, 0);
      const Analysis analysis = analysis_of(simulation, displacement);
      for_each_stroke(
          simulation, displacement, analysis, [&](const JawReading& reading, double truth) {
            const std::string name(reading.definition->name);
            if (std::find(std::begin(kGreatestValues), std::end(kGreatestValues), name) ==
                std::end(kGreatestValues)) {
              return;
            }
            // No noise explains four half intervals.
            const double half = (reading.high - reading.low) / 2;
            if (!(std::abs(reading.value - truth) > 4 * half)) return;
            EXPECT_EQ(reading.provenance, ReadingProvenance::derived) << name;
            EXPECT_NE(reading.reason.find("faults of the instrument"), std::string::npos)
                << reading.reason;
            ++derived;
          });
    }
  }
  EXPECT_GT(derived, 20);
}

// The instant of a greatest value is the top of means, beside which a tremor has higher ones. What
// is read at that instant differs at these.
TEST(ShortMovements, OfATremorAreInTheIntervalsOfGreatestValues) {
  const int runs = testing_support::runs(1, 1, 20);
  Coverages coverages;
  for (const double amplitude_m : {1e-4, 2.5e-4, 6e-4}) {
    for (const double frequency_Hz : {4.0, 6.0, 9.0}) {
      for (int run = 0; run < runs; ++run) {
        compare_strokes(simulation_of(200, 1e-4, run), tremor(amplitude_m, frequency_Hz),
                        coverages);
      }
    }
  }
  print(coverages);
  std::vector<const char*> names(std::begin(kGreatestValues), std::end(kGreatestValues));
  names.insert(names.end(), std::begin(kReadAtTop), std::end(kReadAtTop));
  const std::size_t mostly_known = names.size();
  names.insert(names.end(), std::begin(kPathsToTop), std::end(kPathsToTop));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const char* const name = names[i];
    const Coverage& coverage = coverages[name];
    EXPECT_GT(coverage.shown, (i < mostly_known ? 0.9 : 0.5) * coverage.wanted) << name;
    // As above.
    EXPECT_GE(static_cast<std::uint64_t>(coverage.covered),
              testing_support::fewest_hits(static_cast<std::uint64_t>(coverage.shown), 0.75, 1e-4))
        << name;
  }
}

// A condyle goes aside while its travel hardly changes: where the path ends is not known.
TEST(ShortMovements, OfADriftAtTheTopAreInTheIntervalsOfPaths) {
  const int runs = testing_support::runs(2, 6, 40);
  for (const double tremor_m : {0.0, 1e-4, 4e-4}) {
    SCOPED_TRACE(testing::Message() << "tremor " << tremor_m << " m");
    Coverages coverages;
    for (const double amplitude_m : {1e-3, 3e-3}) {
      for (int run = 0; run < runs; ++run) {
        compare_strokes(simulation_of(200, 1e-4, run), drift(amplitude_m, tremor_m), coverages);
      }
    }
    print(coverages);
    for (const char* name : kPathsToTop) {
      const Coverage& coverage = coverages[name];
      if (tremor_m < 2e-4) {
        EXPECT_GT(coverage.shown, 0.3 * coverage.wanted) << name;
      }
      // As above.
      EXPECT_GE(
          static_cast<std::uint64_t>(coverage.covered),
          testing_support::fewest_hits(static_cast<std::uint64_t>(coverage.shown), 0.85, 1e-4))
          << name;
    }
  }
}

}  // namespace
}  // namespace condyle::host
