// SPDX-License-Identifier: Apache-2.0
#include "readings/cycle_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "readings/path_measures.h"
#include "readings/reading.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr double kNone = JawReading::kNone;
constexpr double kOcclusalDepth_m = 0.5e-3, kSlowShare = 0.5;
constexpr double kClosingFrom = 0.2, kClosingTo = 0.8;  // of the height
constexpr int kClosingSteps = 12;

void give(double value, const char* reason, std::vector<double>& values,
          std::vector<std::string>* why) {
  values.push_back(value);
  if (why != nullptr) why->push_back(std::isfinite(value) ? "" : reason);
}

// When a cubic through two samples with these rates is at `level`; it is on both sides of it.
double crossing_s(double from_s, double to_s, double from, double to, double from_rate,
                  double to_rate, double level) {
  const double step_s = to_s - from_s;
  const auto at = [&](double x) {
    const double y = 1 - x;
    return y * y * (1 + 2 * x) * from + x * x * (1 + 2 * y) * to +
           x * y * step_s * (y * from_rate - x * to_rate);
  };
  const double sign = from < level ? 1 : -1;
  return from_s + step_s * share_of_passage(sign * (from - level), sign * (to - level),
                                            [&](double x) { return sign * (at(x) - level); });
}

double occlusal_time_s(const CycleMarks& cycle, const std::vector<double>& time_s,
                       const std::vector<double>& z, const std::vector<double>& rates,
                       const GreatestAt& greatest) {
  const double top_m = greatest.of(z, cycle.turn, z.size()).value;
  const double level_m = top_m - kOcclusalDepth_m;
  std::size_t up = cycle.end, down = cycle.end;
  while (up > cycle.turn && z[up] >= level_m) --up;
  while (down < z.size() && z[down] >= level_m) ++down;
  if (up == cycle.end || down >= z.size() || z[up] >= level_m) return kNone;
  const auto passage_s = [&](std::size_t k) {
    return crossing_s(time_s[k], time_s[k + 1], z[k], z[k + 1], rates[k], rates[k + 1], level_m);
  };
  return passage_s(down - 1) - passage_s(up);
}

double slow_close_s(const CycleMarks& cycle, const std::vector<double>& time_s,
                    const std::vector<double>& rates, const GreatestAt& greatest) {
  const Greatest peak = greatest.of(rates, cycle.turn, cycle.end + 1);
  const double slow_m_s = kSlowShare * peak.value;
  for (std::size_t k = peak.at; k < cycle.end; ++k) {
    if (rates[k] < slow_m_s || rates[k + 1] > slow_m_s) continue;
    const double share = (rates[k] - slow_m_s) / (rates[k] - rates[k + 1]);
    return cycle.end_s - (time_s[k] + share * (time_s[k + 1] - time_s[k]));
  }
  return kNone;
}

// Area of the loop in the plane of `axis` and Z, from what the rays sweep.
double loop_area_m2(const CycleMarks& cycle, const JawPath& path, int axis, double swept) {
  const Vector3d &first = path.incisor_m[cycle.begin], &last = path.incisor_m[cycle.end];
  return (swept + last[axis] * first.z() - last.z() * first[axis]) / 2;
}

// Points of the closing path at equal steps of height; empty if it does not pass them.
Points closing_points(const CycleMarks& cycle, const JawPath& path) {
  const double bottom_m = path.incisor_m[cycle.turn].z();
  const double height_m = path.incisor_m[cycle.end].z() - bottom_m;
  Points points;
  std::size_t from = cycle.turn;
  for (int i = 0; i <= kClosingSteps; ++i) {
    const double share = kClosingFrom + (kClosingTo - kClosingFrom) * i / kClosingSteps;
    const auto passage = first_passage(path.time_s, path.incisor_m, path.incisor_m_s, from,
                                       cycle.end, bottom_m + share * height_m, CoordinateOf{2});
    if (!passage) return {};
    points.push_back(passage->point);
    if (height_m > 0) from = passage->after;  // all before lies lower still
  }
  return points;
}

}  // namespace

CycleIntegrals integrals_of(const CycleMarks& cycle, const JawPath& path) {
  // Length, then what is swept with Y and with X.
  using Measures = std::array<double, 3>;
  const auto measured = [](const Vector3d& point, const Vector3d& rate) {
    return Measures{rate.norm(), point.y() * rate.z() - point.z() * rate.y(),
                    point.x() * rate.z() - point.z() * rate.x()};
  };
  Measures sums{};
  Measures before = measured(path.incisor_m[cycle.begin], path.incisor_m_s[cycle.begin]);
  for (std::size_t k = cycle.begin; k < cycle.end; ++k) {
    const Vector3d &p = path.incisor_m[k], &q = path.incisor_m[k + 1];
    const Vector3d &v = path.incisor_m_s[k], &w = path.incisor_m_s[k + 1];
    const double step_s = path.time_s[k + 1] - path.time_s[k];
    const Vector3d middle = (p + q) / 2 + step_s / 8 * (v - w);
    const Vector3d rate = 1.5 * (q - p) / step_s - (v + w) / 4;
    const Measures between = measured(middle, rate), after = measured(q, w);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      sums[i] += step_s / 6 * (before[i] + 4 * between[i] + after[i]);
    }
    before = after;
  }
  return {sums[0], sums[1], sums[2]};
}

std::vector<std::string_view> names_of_cycle_shape() {
  return {"occlusal_time_s", "slow_close_time_s", "cycle_path_mm"};
}

std::vector<std::string_view> names_of_cycle_shape_with_landmarks() {
  return {"opening_peak_vertical_speed_mm_s", "closing_peak_vertical_speed_mm_s",
          "closing_angle_deg", "cycle_frontal_area_mm2", "cycle_sagittal_area_mm2"};
}

void add_cycle_shape(const CycleMarks& cycle, const JawPath& path, const CycleIntegrals& integrals,
                     const std::vector<double>& heights_m, const std::vector<double>& rates_m_s,
                     const GreatestAt& greatest, std::vector<double>& values,
                     std::vector<std::string>* why) {
  const auto& time_s = path.time_s;
  give(cycle.ends_with_pause ? kNone
                             : occlusal_time_s(cycle, time_s, heights_m, rates_m_s, greatest),
       "no cycle follows at once", values, why);
  give(slow_close_s(cycle, time_s, rates_m_s, greatest), "the closing speed has no peak", values,
       why);
  give(integrals.length_m * 1e3, "it could not be computed", values, why);
}

void add_cycle_shape_with_landmarks(const CycleMarks& cycle, const JawPath& path,
                                    const CycleIntegrals& integrals, const GreatestAt& greatest,
                                    std::vector<double>& values, std::vector<std::string>* why) {
  const char* const failed = "it could not be computed";
  for (const double way : {-1.0, 1.0}) {
    std::vector<double> rates;
    rates.reserve(path.incisor_m_s.size());
    for (const Vector3d& rate : path.incisor_m_s) rates.push_back(way * rate.z());
    const std::size_t from = way < 0 ? cycle.begin : cycle.turn;
    const std::size_t to = way < 0 ? cycle.turn : cycle.end;
    give(greatest.of(rates, from, to + 1).value * 1e3, failed, values, why);
  }
  const Points closing = closing_points(cycle, path);
  double angle_rad = kNone, side_m = kNone;
  if (!closing.empty()) {
    const Vector3d chord = closing.back() - closing.front();
    angle_rad = std::atan2(chord.z(), std::abs(chord.y()));
    double sum = -(closing.front().y() + closing.back().y()) / 2;  // trapezoidal rule
    for (const Vector3d& point : closing) sum += point.y();
    side_m =
        sum / kClosingSteps - (path.incisor_m[cycle.begin].y() + path.incisor_m[cycle.end].y()) / 2;
  }
  const char* const unsteady = "the jaw does not close steadily";
  give(angle_rad / std::numbers::pi * 180, unsteady, values, why);
  const double frontal_mm2 = 1e6 * loop_area_m2(cycle, path, 1, integrals.frontal_m2);
  const double sagittal_mm2 = 1e6 * loop_area_m2(cycle, path, 0, integrals.sagittal_m2);
  give(std::abs(frontal_mm2), failed, values, why);
  give(std::abs(sagittal_mm2), failed, values, why);
  give(side_m * 1e3, unsteady, values, why);
  give(frontal_mm2, failed, values, why);
  give(sagittal_mm2, failed, values, why);
}

}  // namespace condyle::host
