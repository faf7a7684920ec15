// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/jaw_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "statistics/random.h"

namespace condyle::host {
namespace {

constexpr std::uint64_t kFirstMotionStream = 20;  // one for each task
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kTaskMargin = 0.4;  // of the gap before and after a task, that belongs to it

// A factor about 1.
double vary(double spread, RandomGenerator& random) {
  return std::max(0.3, 1 + spread * std::clamp(random.normal(), -2.5, 2.5));
}

// Acceleration at the ends of a sinusoidal way of `size` in `duration_s`.
double sine_acceleration(double size, double duration_s) {
  const double rate = std::numbers::pi / duration_s;
  return size / 2 * rate * rate;
}

JawSide other(JawSide side) {
  return side == JawSide::left ? JawSide::right : JawSide::left;
}

}  // namespace

class JawMotionPlanner {
 public:
  JawMotionPlanner(const JawScenario& scenario, JawMotionPlan& plan)
      : scenario_(scenario), plan_(plan) {
    now_s_ = scenario.gap_s;
    for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
      const JawTask& task = scenario.tasks[i];
      random_ = RandomGenerator(scenario.motion_seed, kFirstMotionStream + i);
      const double margin_s = kTaskMargin * scenario.gap_s;
      JawTaskSpan span{task.kind, now_s_ - margin_s, 0};
      plan_task(task);
      span.end_s = now_s_ + margin_s;
      plan.tasks_.push_back(span);
      now_s_ += scenario.gap_s;
    }
    plan.duration_s_ = now_s_;
  }

 private:
  struct Cycle {
    double size, opening_s, closing_s;
    double duration_s() const { return opening_s + closing_s; }
  };
  // Excursions in a border sweep: m and rad.
  struct Border {
    double both_m, orbit_m, opening_rad;
  };

  void plan_task(const JawTask& task) {
    switch (task.kind) {
      case JawTaskKind::rest:
        now_s_ += task.duration_s;
        return;
      case JawTaskKind::border:
        return sweep_border(task);
      case JawTaskKind::chewing:
        return chew(task);
      default:
        return make_strokes(task);
    }
  }

  SmoothTrack& advance_of(JawSide side) {
    return side == JawSide::left ? plan_.left_ : plan_.right_;
  }
  void set_orbiting(JawSide side) { plan_.orbits_.push_back({now_s_, side}); }

  void make_strokes(const JawTask& task) {
    const JawSide orbiting = task.kind == JawTaskKind::left    ? JawSide::right
                             : task.kind == JawTaskKind::right ? JawSide::left
                                                               : JawSide::none;
    const double delay = task.kind == JawTaskKind::opening ? scenario_.translation_delay : 0;
    for (int stroke = 1; stroke <= task.strokes; ++stroke) {
      if (stroke > 1) now_s_ += task.rest_s;
      set_orbiting(orbiting);
      const double size = vary(task.size_spread, random_);
      const double way_s = task.stroke_s * vary(task.duration_spread, random_);
      const JawStroke one{task.kind,
                          stroke,
                          now_s_,
                          now_s_ + way_s,
                          now_s_ + way_s + task.hold_s,
                          now_s_ + 2 * way_s + task.hold_s};
      const auto out_and_back = [&one](SmoothTrack& track, double target, double delay_s) {
        track.move_to(target, one.begin_s + delay_s, one.outward_end_s);
        track.move_to(0, one.return_begin_s, one.end_s - delay_s);
      };
      const double advance_m = size * task.advance_mm * 1e-3;
      out_and_back(plan_.opening_, size * task.angle_deg * kDegree, 0);
      if (orbiting == JawSide::none) {
        out_and_back(plan_.both_, advance_m, delay * way_s);
      } else {
        out_and_back(advance_of(orbiting), advance_m, 0);
        out_and_back(advance_of(other(orbiting)), scenario_.working_share * advance_m, 0);
      }
      plan_.strokes_.push_back(one);
      now_s_ = one.end_s;
    }
  }

  // The sizes of this scenario's task, or typical ones.
  JawTask sizes_of(JawTaskKind kind) const {
    const auto found = std::find_if(scenario_.tasks.begin(), scenario_.tasks.end(),
                                    [kind](const JawTask& task) { return task.kind == kind; });
    return found == scenario_.tasks.end() ? default_task(kind) : *found;
  }

  void go_to(const Border& target, JawSide orbiting, double way_s) {
    const double end_s = now_s_ + way_s;
    plan_.both_.move_to(target.both_m, now_s_, end_s);
    plan_.opening_.move_to(target.opening_rad, now_s_, end_s);
    if (orbiting != JawSide::none) {
      advance_of(orbiting).move_to(target.orbit_m, now_s_, end_s);
    }
    now_s_ = end_s;
  }

  // Each sweep: back border, full opening, front border, protrusion; then both lateral borders.
  void sweep_border(const JawTask& task) {
    const JawTask protrusion = sizes_of(JawTaskKind::protrusion);
    const JawTask lateral = sizes_of(JawTaskKind::left);
    constexpr double hinge_share = 0.4;  // of the opening angle: no condylar advance up to it
    const Border closed{};
    const Border hinge{0, 0, hinge_share * task.angle_deg * kDegree};
    const Border open{task.advance_mm * 1e-3, 0, task.angle_deg * kDegree};
    const Border front{protrusion.advance_mm * 1e-3, 0, protrusion.angle_deg * kDegree};
    const Border side{0, lateral.advance_mm * 1e-3, lateral.angle_deg * kDegree};
    for (int sweep = 1; sweep <= task.strokes; ++sweep) {
      if (sweep > 1) now_s_ += task.rest_s;
      set_orbiting(JawSide::none);
      for (const Border& target : {hinge, open, front, closed}) {
        go_to(target, JawSide::none, task.stroke_s);
      }
      for (const JawSide orbiting : {JawSide::right, JawSide::left}) {
        set_orbiting(orbiting);
        for (const Border& target : {side, open, closed}) go_to(target, orbiting, task.stroke_s);
      }
    }
  }

  void chew(const JawTask& task) {
    const double end_s = now_s_ + task.duration_s;
    const ChewingPattern& pattern = task.chewing;
    JawSide working = pattern.first_side;
    for (int sequence = 1;; ++sequence) {
      const std::vector<Cycle> cycles = draw_sequence(task, end_s);
      if (cycles.empty()) break;
      plan_sequence(task, sequence, cycles, working);
      now_s_ += pattern.pause_s;
      set_orbiting(JawSide::none);
      if (pattern.swallows) swallow(end_s, pattern.pause_s);
      if (pattern.speech_s > 0) speak(end_s, pattern.speech_s, pattern.pause_s);
    }
    now_s_ = std::max(now_s_, end_s);
  }

  // Cycles that end before `end_s`.
  std::vector<Cycle> draw_sequence(const JawTask& task, double end_s) {
    std::vector<Cycle> cycles;
    double left_s = end_s - now_s_;
    for (int i = 0; i < task.chewing.cycles_in_sequence; ++i) {
      const double size = vary(task.size_spread, random_);
      const double duration_s = task.chewing.cycle_s * vary(task.duration_spread, random_);
      left_s -= duration_s;
      if (left_s < 0) break;
      const double opening_s = task.chewing.opening_share * duration_s;
      cycles.push_back({size, opening_s, duration_s - opening_s});
    }
    return cycles;
  }

  void plan_sequence(const JawTask& task, int sequence, const std::vector<Cycle>& cycles,
                     JawSide& working) {
    const auto move = [&](double size, double way_s, double first, double last) {
      const auto scaled = [&](SmoothTrack& track, double full) {
        track.move_to(full * size, now_s_, now_s_ + way_s, full * first, full * last);
      };
      scaled(plan_.opening_, task.angle_deg * kDegree);
      scaled(plan_.both_, task.advance_mm * 1e-3);
      now_s_ += way_s;
    };
    double closed_before = 0;
    for (std::size_t i = 0; i < cycles.size(); ++i) {
      const Cycle& cycle = cycles[i];
      const double begin_s = now_s_;
      const double opening = sine_acceleration(cycle.size, cycle.opening_s);
      const double closing = sine_acceleration(cycle.size, cycle.closing_s);
      const double closed_after =
          i + 1 == cycles.size()
              ? 0
              : task.chewing.closed_acceleration / 2 *
                    (closing + sine_acceleration(cycles[i + 1].size, cycles[i + 1].opening_s));
      const bool is_reversed = random_.uniform() < task.chewing.reversed_share;
      set_orbiting(other(working));
      move(cycle.size, cycle.opening_s, closed_before, -(opening + closing) / 2);
      const double open_s = now_s_;
      move(0, cycle.closing_s, -(opening + closing) / 2, closed_after);
      // The jaw is farthest on the working side while it closes; opens, if the loop is reversed.
      const double peak_s =
          is_reversed ? begin_s + 0.65 * cycle.opening_s : open_s + 0.35 * cycle.closing_s;
      SmoothTrack& orbit = advance_of(other(working));
      orbit.move_to(cycle.size * task.chewing.lateral_advance_mm * 1e-3, begin_s, peak_s);
      orbit.move_to(0, peak_s, now_s_);
      plan_.cycles_.push_back({sequence, static_cast<int>(plan_.cycles_.size()) + 1, begin_s,
                               open_s, now_s_, working, is_reversed});
      if (task.chewing.alternates) working = other(working);
      closed_before = closed_after;
    }
  }

  // Opening angle that moves the incisor by `way_mm`.
  double angle_of(double way_mm) const {
    const JawAnatomy& jaw = scenario_.anatomy;
    return way_mm /
           std::sqrt(jaw.incisor_x_mm * jaw.incisor_x_mm + jaw.incisor_z_mm * jaw.incisor_z_mm);
  }
  void turn_to(double angle_rad, double way_s) {
    plan_.opening_.move_to(angle_rad, now_s_, now_s_ + way_s);
    now_s_ += way_s;
  }

  void swallow(double end_s, double pause_s) {
    const double way_s = 0.2 + 0.15 * random_.uniform(), size_mm = 1 + 2 * random_.uniform();
    if (now_s_ + 2 * way_s > end_s) return;
    turn_to(angle_of(size_mm), way_s);
    turn_to(0, way_s);
    now_s_ += pause_s;
  }

  void speak(double end_s, double duration_s, double pause_s) {
    if (now_s_ + duration_s > end_s) return;
    const double last_s = now_s_ + duration_s;
    for (;;) {
      const double way_s = 0.5 / (3 + 2 * random_.uniform());
      const double open_mm = 2 + 3 * random_.uniform(), closed_mm = 0.8 * random_.uniform();
      const bool is_last = now_s_ + 4 * way_s > last_s;
      turn_to(angle_of(open_mm), way_s);
      turn_to(is_last ? 0 : angle_of(closed_mm), way_s);
      if (is_last) break;
    }
    now_s_ += pause_s;
  }

  const JawScenario& scenario_;
  JawMotionPlan& plan_;
  RandomGenerator random_{0};
  double now_s_ = 0;
};

JawMotionPlan::JawMotionPlan(const JawScenario& scenario) {
  const JawMotionPlanner planner(scenario, *this);
}

JawCoordinates JawMotionPlan::at(double time_s) const {
  JawCoordinates result;
  const double both_m = both_.at(time_s), left_m = left_.at(time_s), right_m = right_.at(time_s);
  result.left_m = both_m + left_m;
  result.right_m = both_m + right_m;
  result.opening_rad = opening_.at(time_s);
  const auto after =
      std::upper_bound(orbits_.begin(), orbits_.end(), time_s,
                       [](double time, const Orbit& orbit) { return time < orbit.begin_s; });
  if (after != orbits_.begin()) result.orbiting = std::prev(after)->orbiting;
  if (result.orbiting == JawSide::left) result.lateral_m = left_m;
  if (result.orbiting == JawSide::right) result.lateral_m = right_m;
  return result;
}

double JawMotionPlan::greatest_advance_m() const {
  constexpr double step_s = 0.01;
  double greatest_m = 0;
  for (double time_s = 0; time_s < duration_s_; time_s += step_s) {
    const JawCoordinates now = at(time_s);
    greatest_m = std::max({greatest_m, now.left_m, now.right_m});
  }
  return greatest_m;
}

}  // namespace condyle::host
