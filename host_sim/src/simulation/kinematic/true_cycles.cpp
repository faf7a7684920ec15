// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/true_cycles.h"

#include <cmath>

#include "simulation/kinematic/true_readings.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;
using namespace truth;

constexpr double kContact_mm = 0.5;  // below the closed position: occlusal time
constexpr double kLeastSide_mm = 1;  // of the closing path
constexpr int kHeights = 121;        // at which the closing path is taken

}  // namespace

TruthOfCycles::TruthOfCycles(const KinematicJaw& jaw, const std::vector<JawCycle>& cycles)
    : jaw_(jaw), cycles_(cycles) {
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    TrueCycle one;
    one.number = cycles[i].cycle;
    read_times(i, one);
    read_sizes(cycles[i], one);
    read_loop(cycles[i], one);
    true_.push_back(std::move(one));
  }
  summarise();
}

Vector3d TruthOfCycles::incisor_mm(double time_s) const {
  return displacement_mm(jaw_.pose_at(time_s), jaw_.landmarks().incisor_lower);
}

double TruthOfCycles::speed_mm_s(double time_s) const {
  return truth::speed_mm_s([this](double t) { return incisor_mm(t); }, time_s);
}

double TruthOfCycles::upward_mm_s(double time_s) const {
  return velocity_mm_s([this](double t) { return incisor_mm(t); }, time_s).z();
}

void TruthOfCycles::read_times(std::size_t at, TrueCycle& into) const {
  const JawCycle& cycle = cycles_[at];
  const Span closing{cycle.opening_end_s, cycle.end_s};
  into.values.push_back({"cycle_duration_s", cycle.end_s - cycle.begin_s, "s"});
  into.values.push_back({"opening_time_s", cycle.opening_end_s - cycle.begin_s, "s"});
  into.values.push_back({"closing_time_s", cycle.end_s - cycle.opening_end_s, "s"});
  const auto upward = [this](double t) { return upward_mm_s(t); };
  const double peak_s = greatest_at_s(upward, closing), half = upward(peak_s) / 2;
  const auto slow_s =
      first_passage_s([&](double t) { return -upward(t); }, {peak_s, cycle.end_s}, -half);
  if (slow_s) into.values.push_back({"slow_close_time_s", cycle.end_s - *slow_s, "s"});
  // Only where another cycle follows at once.
  if (at + 1 == cycles_.size() || cycles_[at + 1].sequence != cycle.sequence) return;
  const double level_mm = incisor_mm(cycle.end_s).z() - kContact_mm;
  const auto height = [this](double t) { return incisor_mm(t).z(); };
  const auto from_s = first_passage_s(height, closing, level_mm);
  const auto to_s = first_passage_s([&](double t) { return -height(t); },
                                    {cycle.end_s, cycles_[at + 1].opening_end_s}, -level_mm);
  if (from_s && to_s) into.values.push_back({"occlusal_time_s", *to_s - *from_s, "s"});
}

void TruthOfCycles::read_sizes(const JawCycle& cycle, TrueCycle& into) const {
  const Span opening{cycle.begin_s, cycle.opening_end_s};
  const Span closing{cycle.opening_end_s, cycle.end_s}, whole{cycle.begin_s, cycle.end_s};
  const auto range = [&](int axis) {
    return greatest([&](double t) { return incisor_mm(t)[axis]; }, whole) +
           greatest([&](double t) { return -incisor_mm(t)[axis]; }, whole);
  };
  into.values.push_back({"cycle_height_mm", range(2), "mm"});
  into.values.push_back({"cycle_width_mm", range(1), "mm"});
  into.values.push_back({"cycle_depth_mm", range(0), "mm"});
  const auto speed = [this](double t) { return speed_mm_s(t); };
  into.values.push_back({"cycle_path_mm", integral(speed, whole), "mm"});
  const auto upward = [this](double t) { return upward_mm_s(t); };
  const auto downward = [this](double t) { return -upward_mm_s(t); };
  const TrueSmoothness there = smoothness(speed, opening, 0), home = smoothness(speed, closing, 0);
  into.values.push_back({"sparc", there.sparc, "1"});
  into.values.push_back({"ldlj", there.ldlj, "1"});
  into.values.push_back({"closing_sparc", home.sparc, "1"});
  into.values.push_back({"closing_ldlj", home.ldlj, "1"});
  into.values.push_back({"opening_peak_speed_mm_s", greatest(speed, opening), "mm/s"});
  into.values.push_back({"closing_peak_speed_mm_s", greatest(speed, closing), "mm/s"});
  into.values.push_back({"opening_peak_vertical_speed_mm_s", greatest(downward, opening), "mm/s"});
  into.values.push_back({"closing_peak_vertical_speed_mm_s", greatest(upward, closing), "mm/s"});
}

void TruthOfCycles::read_loop(const JawCycle& cycle, TrueCycle& into) const {
  // Twice the areas: what the ray from the origin sweeps, and the triangle that closes the loop.
  const Vector3d first = incisor_mm(cycle.begin_s), end = incisor_mm(cycle.end_s);
  const auto place_mm = [this](double t) { return incisor_mm(t); };
  const auto swept = [&](int axis) {
    const auto rate = [&](double t) {
      const Vector3d p = incisor_mm(t), v = velocity_mm_s(place_mm, t);
      return p[axis] * v.z() - p.z() * v[axis];
    };
    return integral(rate, {cycle.begin_s, cycle.end_s}) + end[axis] * first.z() -
           first[axis] * end.z();
  };
  const double frontal = swept(1), sagittal = swept(0);
  into.values.push_back({"cycle_frontal_area_mm2", std::abs(frontal) / 2, "mm2"});
  into.values.push_back({"cycle_sagittal_area_mm2", std::abs(sagittal) / 2, "mm2"});
  const Vector3d bottom = incisor_mm(cycle.opening_end_s);
  const auto height = [this](double t) { return incisor_mm(t).z(); };
  std::vector<Vector3d> closing;
  double from_s = cycle.opening_end_s;  // heights are asked for in rising order
  for (int i = 0; i < kHeights; ++i) {
    const double share = 0.2 + 0.6 * i / (kHeights - 1);
    const auto time_s =
        first_passage_s(height, {from_s, cycle.end_s}, bottom.z() + share * (end.z() - bottom.z()));
    if (!time_s) return;
    from_s = *time_s;
    closing.push_back(incisor_mm(*time_s));
  }
  const Vector3d line = closing.back() - closing.front();
  into.values.push_back(
      {"closing_angle_deg", kDegrees * std::atan2(line.z(), std::abs(line.y())), "deg"});
  double aside_mm = 0;
  for (const Vector3d& point : closing) aside_mm += point.y() / kHeights;
  aside_mm -= (first.y() + end.y()) / 2;
  if (std::abs(aside_mm) < kLeastSide_mm) return;
  into.side = aside_mm > 0 ? JawSide::left : JawSide::right;
  into.is_reversed = (into.side == JawSide::left) == (frontal < 0);
}

void TruthOfCycles::summarise() {
  const auto count = static_cast<double>(true_.size());
  double total_s = 0, left = 0, right = 0, reversed = 0;
  for (const JawCycle& cycle : cycles_) total_s += cycle.end_s - cycle.begin_s;
  for (const TrueCycle& cycle : true_) {
    left += cycle.side == JawSide::left;
    right += cycle.side == JawSide::right;
    reversed += cycle.is_reversed;
  }
  summary_.push_back({"cycle_count", count, "1"});
  summary_.push_back({"cycle_frequency_Hz", count / total_s, "Hz"});
  summary_.push_back({"side_cycle_count", left, "1", JawSide::left});
  summary_.push_back({"side_cycle_count", right, "1", JawSide::right});
  summary_.push_back({"midline_cycle_count", count - left - right, "1"});
  summary_.push_back({"reversed_loop_count", reversed, "1"});
  if (left + right > 0) {
    summary_.push_back({"laterality_index", (right - left) / (right + left), "1"});
  }
  add_scatter("cycle_duration_s", "cycle_duration_sd_s", "cycle_duration_cv_percent",
              "cycle_duration_change_s", "s");
  add_scatter("closing_peak_speed_mm_s", "closing_peak_speed_sd_mm_s",
              "closing_peak_speed_cv_percent", "closing_peak_speed_change_mm_s", "mm/s");
  add_scatter("cycle_height_mm", "cycle_height_sd_mm", "cycle_height_cv_percent",
              "cycle_height_change_mm", "mm");
  add_scatter("cycle_width_mm", "cycle_width_sd_mm", "cycle_width_cv_percent",
              "cycle_width_change_mm", "mm");
}

void TruthOfCycles::add_scatter(const std::string& of, const std::string& sd,
                                const std::string& relative, const std::string& change,
                                const char* unit) {
  std::vector<double> all;
  for (const TrueCycle& cycle : true_) {
    for (const TrueCycleValue& value : cycle.values) {
      if (value.reading == of) all.push_back(value.value);
    }
  }
  if (all.size() < 3) return;
  const auto count = static_cast<double>(all.size());
  double sum = 0, squares = 0;
  for (const double value : all) sum += value;
  for (const double value : all) squares += (value - sum / count) * (value - sum / count);
  const double deviation = std::sqrt(squares / (count - 1));
  summary_.push_back({sd, deviation, unit});
  summary_.push_back({relative, 100 * deviation / (sum / count), "%"});
  const std::size_t third = all.size() / 3;
  double difference = 0;
  for (std::size_t i = 0; i < third; ++i) {
    difference += (all[all.size() - 1 - i] - all[i]) / static_cast<double>(third);
  }
  summary_.push_back({change, difference, unit});
}

std::vector<JawCycle> true_cycles(const KinematicJaw& jaw) {
  std::vector<JawCycle> cycles = jaw.motion().cycles();
  const auto height = [&jaw](double time_s) {
    return displacement_mm(jaw.pose_at(time_s), jaw.landmarks().incisor_lower).z();
  };
  for (JawCycle& cycle : cycles) {
    double lowest_s = cycle.opening_end_s, lowest = height(lowest_s);
    at_instants({cycle.begin_s, cycle.end_s}, [&](double time_s) {
      const double now = height(time_s);
      if (now >= lowest) return;
      lowest = now;
      lowest_s = time_s;
    });
    double from_s = lowest_s - kStep_s, to_s = lowest_s + kStep_s;
    for (int i = 0; i < 30; ++i) {
      const double third_s = (to_s - from_s) / 3;
      if (height(from_s + third_s) < height(to_s - third_s)) {
        to_s -= third_s;
      } else {
        from_s += third_s;
      }
    }
    cycle.opening_end_s = (from_s + to_s) / 2;
  }
  return cycles;
}

}  // namespace condyle::host
