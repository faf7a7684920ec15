// SPDX-License-Identifier: Apache-2.0
#include "readings/task_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <utility>

#include "readings/chewing_summary.h"
#include "readings/cycle_values.h"
#include "readings/kinematic_centre.h"
#include "readings/reading_groups.h"
#include "readings/stroke_readings.h"
#include "readings/stroke_values.h"
#include "readings/strokes.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr std::uint64_t kSeed = 20, kStreamOfCentres = 1;
constexpr double kLeastStroke_m = 1.5e-3;
constexpr double kMargin_s = 0.15, kNewSequence_s = 2;

// What a task's readings assume, beside the assumptions of all tasks.
struct TaskAssumptions {
  bool is_found = false;  // the task, not stated
  std::string jumps;      // on samples that were not used; empty: there are none of a jaw
};

class TaskReader {
 public:
  TaskReader(Analysis& analysis, const TaskContext& context)
      : analysis_(analysis), context_(context) {}

  void read(TaskKind kind) {
    std::vector<SampleRun> windows;
    TaskAssumptions assumptions;
    for (const Task& task : analysis_.tasks) {
      if (task.kind != kind) continue;
      windows.push_back(samples_of(task, analysis_.path.time_s));
      assumptions.is_found = assumptions.is_found || task.is_found;
    }
    if (windows.empty()) return;
    if (kind == TaskKind::chewing) return read_chewing(windows, assumptions);
    read_strokes(kind, windows, assumptions);
  }

  // Condylar inclination of mediotrusion minus that of protrusion, by side.
  void read_fischer() {
    const auto& definition = definition_of("fischer_angle_5mm_deg");
    for (const Side side : {Side::left, Side::right}) {
      const TaskKind orbiting = side == Side::left ? TaskKind::right : TaskKind::left;
      const auto mediotrusion =
          means_.find(mean_key(orbiting, "condylar_inclination_5mm_deg", side));
      const auto protrusion =
          means_.find(mean_key(TaskKind::protrusion, "condylar_inclination_5mm_deg", side));
      if (mediotrusion == means_.end() || protrusion == means_.end()) continue;
      const UncertainValue difference = difference_of(mediotrusion->second, protrusion->second);
      add(definition, orbiting, side, 0, difference,
          {false, jumps_in_strokes({orbiting, TaskKind::protrusion})});
    }
  }

  // Kinematic centres, from openings and protrusions.
  void read_centres() {
    const auto has_task = [this](TaskKind kind) {
      return std::any_of(analysis_.tasks.begin(), analysis_.tasks.end(),
                         [kind](const Task& task) { return task.kind == kind; });
    };
    if (!context_.has_landmarks || !has_task(TaskKind::opening) ||
        !has_task(TaskKind::protrusion)) {
      return;
    }
    const TaskAssumptions assumptions{false,
                                      jumps_in_strokes({TaskKind::opening, TaskKind::protrusion})};
    for (const Side side : {Side::left, Side::right}) {
      RandomGenerator random(kSeed, kStreamOfCentres);
      std::array<UncertainValue, 2> centre;
      if (context_.rotation_problem.empty()) {
        centre = kinematic_centre(
            *context_.motion, *context_.noise, context_.errors, whole_strokes_[TaskKind::opening],
            whole_strokes_[TaskKind::protrusion], side == Side::left ? 0 : 1, random);
      }
      add(definition_of("kinematic_centre_x_mm"), TaskKind::protrusion, side, 0, centre[0],
          assumptions);
      add(definition_of("kinematic_centre_z_mm"), TaskKind::protrusion, side, 0, centre[1],
          assumptions);
    }
  }

 private:
  static std::string mean_key(TaskKind kind, std::string_view name, Side side) {
    return fmt::format("{}/{}/{}", name_of(kind), name, name_of(side));
  }

  // What readings of `runs` assume about samples there that were not used, but may be of a jaw;
  // empty: there are none.
  std::string jumps_in(const std::vector<SampleRun>& runs) const {
    for (const SampleRun& run : runs) {
      if (const auto jump_s = first_jump_s(*context_.motion, run.begin, run.end)) {
        return fmt::format(
            "samples that jump away from the path at {:.2f} s are assumed to be faults of the "
            "instrument",
            *jump_s);
      }
    }
    return "";
  }

  std::string jumps_in_strokes(std::initializer_list<TaskKind> kinds) {
    std::vector<SampleRun> strokes;
    for (const TaskKind kind : kinds) {
      strokes.insert(strokes.end(), whole_strokes_[kind].begin(), whole_strokes_[kind].end());
    }
    return jumps_in(strokes);
  }

  std::string problem_of(const ReadingDefinition& definition) const {
    if (!context_.unusable.empty()) return context_.unusable;
    if (definition.needs_rotation) return context_.rotation_problem;
    return "";
  }

  JawReading& add(const ReadingDefinition& definition, TaskKind kind, Side side, int stroke,
                  UncertainValue value, const TaskAssumptions& assumptions) {
    const std::string problem = problem_of(definition);
    if (!problem.empty()) {
      value.value = JawReading::kNone;
      value.missing = problem;
    }
    JawReading reading =
        judged(definition, value, kind == TaskKind::chewing ? "cycles" : "strokes");
    reading.task = kind;
    reading.side = side;
    reading.stroke = stroke;
    if (reading.provenance == ReadingProvenance::measured) {
      const auto assume = [&reading](const std::string& assumption) {
        if (assumption.empty()) return;
        reading.reason += (reading.reason.empty() ? "" : "; ") + assumption;
        reading.provenance = ReadingProvenance::derived;
      };
      if (is_condylar(definition.name)) assume(context_.condyle_assumption);
      if (definition.name == "slow_close_time_s") {
        assume("the contact of the teeth is not recorded; the speed stands for it");
      }
      if (is_place(definition.unit)) assume(context_.landmark_assumption);
      assume(context_.reference_assumption);
      if (is_fast(definition.name)) assume(context_.smoothing_assumption);
      assume(assumptions.jumps);
      if (assumptions.is_found) {
        reading.reason += reading.reason.empty() ? "" : "; ";
        reading.reason += "the task was found, not stated";
      }
    }
    analysis_.readings.push_back(std::move(reading));
    return analysis_.readings.back();
  }

  void read_strokes(TaskKind kind, const std::vector<SampleRun>& windows,
                    TaskAssumptions assumptions) {
    const bool is_one =
        kind == TaskKind::rest || kind == TaskKind::border || kind == TaskKind::whole;
    std::vector<double> distance_m;
    for (const auto& point : analysis_.path.incisor_m) distance_m.push_back(point.norm());
    std::vector<SampleRun> strokes;
    for (const SampleRun& window : windows) {
      if (is_one) {
        strokes.push_back(window);
        continue;
      }
      for (SampleRun run : find_strokes(distance_m, window.begin, window.end, kLeastStroke_m)) {
        const auto& time_s = analysis_.path.time_s;
        const std::size_t floor = strokes.empty() ? 0 : strokes.back().end;
        const double begin_s = time_s[run.begin], end_s = time_s[run.end - 1];
        while (run.begin > floor && begin_s - time_s[run.begin - 1] <= kMargin_s) --run.begin;
        while (run.end < time_s.size() && time_s[run.end] - end_s <= kMargin_s) ++run.end;
        strokes.push_back(run);
      }
    }
    const auto names = readings_of_stroke(kind, context_.has_landmarks);
    std::vector<std::vector<UncertainValue>> by_reading(names.size());
    for (StrokeValues& read : values_of_strokes(kind, strokes, analysis_, context_)) {
      for (std::size_t k = 0; k < names.size(); ++k) {
        by_reading[k].push_back(std::move(read.values[k]));
      }
      if (read.has_onset) whole_strokes_[kind].push_back(read.stroke);
    }
    std::vector<UncertainValue> means;
    for (auto& values : by_reading) {
      means.push_back(mean_of(values));
      std::vector<UncertainValue*> repeated;
      for (UncertainValue& value : values) repeated.push_back(&value);
      share_contradictions(repeated);
    }
    for (std::size_t i = 0; i < strokes.size() && !is_one; ++i) {
      assumptions.jumps = jumps_in({strokes[i]});
      for (std::size_t k = 0; k < names.size(); ++k) {
        add(definition_of(names[k].name), kind, names[k].side, static_cast<int>(i + 1),
            by_reading[k][i], assumptions);
      }
    }
    assumptions.jumps = jumps_in(strokes);
    for (std::size_t k = 0; k < names.size(); ++k) {
      UncertainValue& mean = means[k];
      if (strokes.empty())
        mean.missing = "the jaw leaves the reference position by less than 1.5 mm";
      means_[mean_key(kind, names[k].name, names[k].side)] = mean;
      add(definition_of(names[k].name), kind, names[k].side, 0, mean, assumptions);
    }
    withhold_what_needs_landmarks(kind);
  }

  void withhold_what_needs_landmarks(TaskKind kind) {
    if (context_.has_landmarks) return;
    const auto here = readings_of_stroke(kind, false);
    for (const StrokeReading& reading : readings_of_stroke(kind, true)) {
      const bool is_here = std::any_of(here.begin(), here.end(), [&](const StrokeReading& other) {
        return other.name == reading.name && other.side == reading.side;
      });
      if (is_here) continue;
      UncertainValue missing;
      missing.missing = "it needs landmarks; give --landmarks FILE";
      add(definition_of(reading.name), kind, reading.side, 0, missing, {});
    }
  }

  void read_chewing(const std::vector<SampleRun>& windows, TaskAssumptions assumptions) {
    assumptions.jumps = jumps_in(windows);
    const JawPath& path = analysis_.path;
    const auto names = readings_of_cycle(context_.has_landmarks);
    std::vector<CycleToRead> to_read;
    const std::vector<double> heights = heights_of(path, context_.has_landmarks);
    for (const SampleRun& window : windows) {
      if (window.end < window.begin + 5) continue;
      const auto sd_at = analysis_.incisor_sd_m.begin();
      const double sd_m =
          upper_median(std::vector<double>(sd_at + static_cast<std::ptrdiff_t>(window.begin),
                                           sd_at + static_cast<std::ptrdiff_t>(window.end)));
      for (const ChewingCycle& cycle : find_cycles(path.time_s, heights, sd_m, window)) {
        AnalysedCycle analysed{cycle, {}, 0, 1, ""};
        if (!analysis_.cycles.empty()) {
          const AnalysedCycle& last = analysis_.cycles.back();
          analysed.sequence =
              last.sequence + (cycle.begin_s - last.cycle.end_s > kNewSequence_s ? 1 : 0);
        }
        if (cycle.rejected.empty()) {
          to_read.push_back({cycle, sd_m});
          analysed.number = static_cast<int>(to_read.size());
        }
        analysed.assumed = jumps_in({{cycle.begin, cycle.end + 1}});
        analysis_.cycles.push_back(std::move(analysed));
      }
    }
    auto values = values_of_cycles(to_read, context_);
    std::vector<std::vector<UncertainValue>> by_reading(names.size());
    for (AnalysedCycle& cycle : analysis_.cycles) {
      if (cycle.number == 0) continue;
      take_values(std::move(values[static_cast<std::size_t>(cycle.number - 1)]), names.size(),
                  cycle);
      for (std::size_t k = 0; k < names.size(); ++k) by_reading[k].push_back(cycle.values[k]);
    }
    const auto taken = static_cast<int>(to_read.size());
    UncertainValue count;
    count.value = taken;
    add(definition_of("cycle_count"), TaskKind::chewing, Side::none, 0, count, assumptions);
    add_greatest(windows, assumptions);
    for (std::size_t k = 0; k < names.size(); ++k) {
      UncertainValue mean = mean_of(by_reading[k]);
      if (taken == 0) mean.missing = "no chewing cycle was found";
      add(definition_of(names[k]), TaskKind::chewing, Side::none, 0, mean, assumptions);
      if (k == 0) add_frequency(mean, assumptions);
      std::vector<UncertainValue*> repeated;
      for (AnalysedCycle& cycle : analysis_.cycles) {
        if (cycle.number != 0) repeated.push_back(&cycle.values[k]);
      }
      share_contradictions(repeated);
    }
    add_summaries(taken, assumptions);
  }

  // The values of the cycle's readings, then its directions.
  static void take_values(std::vector<UncertainValue> values, std::size_t count,
                          AnalysedCycle& cycle) {
    CycleDirections& directions = cycle.directions;
    UncertainValue* const more[] = {&directions.closing_side_mm, &directions.frontal_area_mm2,
                                    &directions.sagittal_area_mm2, &directions.begin_shift_s};
    for (std::size_t i = 0; count + i < values.size(); ++i) *more[i] = values[count + i];
    values.resize(count);
    cycle.values = std::move(values);
  }

  // Displacement and rotation: the greatest of all windows.
  void add_greatest(const std::vector<SampleRun>& windows, const TaskAssumptions& assumptions) {
    const auto names = readings_of_stroke(TaskKind::whole, context_.has_landmarks);
    std::vector<UncertainValue> greatest;
    for (const auto& read : values_of_strokes(TaskKind::whole, windows, analysis_, context_)) {
      const auto& values = read.values;
      if (greatest.empty()) greatest = values;
      for (std::size_t k = 0; k < names.size(); ++k) {
        if (values[k].value > greatest[k].value) greatest[k] = values[k];
      }
    }
    for (std::size_t k = 0; k < greatest.size(); ++k) {
      add(definition_of(names[k].name), TaskKind::chewing, Side::none, 0, greatest[k], assumptions);
    }
  }

  void add_frequency(const UncertainValue& mean, const TaskAssumptions& assumptions) {
    UncertainValue frequency = mean;
    frequency.value = 1 / mean.value;
    const double slope = frequency.value * frequency.value;
    frequency.noise_sd *= slope;
    frequency.scale_systematic(slope);
    for (double& change : frequency.fixed) change *= slope;
    add(definition_of("cycle_frequency_Hz"), TaskKind::chewing, Side::none, 0, frequency,
        assumptions);
  }

  void add_summaries(int taken, const TaskAssumptions& assumptions) {
    find_sides(analysis_);
    for (CycleSummary& summary : summaries_of(analysis_)) {
      if (taken == 0) summary.value.missing = "no chewing cycle was found";
      if (summary.interval) {
        const auto [low, high] = *summary.interval;
        summary.value.set_half_interval((high - low) / 2);
      }
      JawReading& reading = add(definition_of(summary.name), TaskKind::chewing, summary.side, 0,
                                summary.value, assumptions);
      if (reading.provenance == ReadingProvenance::withheld) continue;
      if (summary.interval) {
        reading.low = summary.interval->front();
        reading.high = summary.interval->back();
      }
      if (summary.remark.empty()) continue;
      reading.reason += (reading.reason.empty() ? "" : "; ") + summary.remark;
      if (summary.is_derived) reading.provenance = ReadingProvenance::derived;
    }
    if (analysis_.has_landmarks && context_.unusable.empty()) {
      analysis_.average_cycles = average_cycles(analysis_.path, analysis_.cycles, context_.errors);
    }
  }

  Analysis& analysis_;
  const TaskContext& context_;
  std::map<std::string, UncertainValue> means_;
  std::map<TaskKind, std::vector<SampleRun>> whole_strokes_;
};

}  // namespace

void read_tasks_of(Analysis& analysis, const TaskContext& context) {
  TaskReader reader(analysis, context);
  for (std::size_t i = 0; i < kTaskKinds; ++i) reader.read(static_cast<TaskKind>(i));
  reader.read(TaskKind::whole);
  reader.read_fischer();
  reader.read_centres();
}

}  // namespace condyle::host
