// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/true_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "simulation/kinematic/true_cycles.h"
#include "simulation/kinematic/true_measures.h"

namespace condyle::host {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using namespace truth;

constexpr double kPathStart_mm = 0.3;                                         // of travel
constexpr double kTravels_mm[] = {3, 5, 10};                                  // of the angles
constexpr double kShiftStart_mm = 2, kShiftEnd_mm = 5, kShiftStep_mm = 0.05;  // of the fit, in x
constexpr double kEarlyShift_mm = 0.5;  // x at which side_shift_05mm is read

// Twist about Y: 2 atan2(q_y, q_w). With q_w = sqrt(1 + trace)/2, 4 q_w q_y = R_13 - R_31.
double opening_angle_deg(const Matrix3d& rotation) {
  return 2 * kDegrees * std::atan2(rotation(0, 2) - rotation(2, 0), 1 + rotation.trace());
}

double rotation_angle_deg(const Matrix3d& rotation) {
  const Vector3d twice_sine(rotation(2, 1) - rotation(1, 2), rotation(0, 2) - rotation(2, 0),
                            rotation(1, 0) - rotation(0, 1));
  return kDegrees * std::atan2(twice_sine.norm(), rotation.trace() - 1);
}

class TruthOfJaw {
 public:
  explicit TruthOfJaw(const KinematicJaw& jaw) : jaw_(jaw) {}

  std::vector<TrueReading> read() {
    for (const JawStroke& stroke : jaw_.motion().strokes()) read_stroke(stroke);
    read_cycles();
    add_means();
    for (const JawTaskSpan& task : jaw_.motion().tasks()) read_task(task);
    add_fischer_angles();
    return std::move(readings_);
  }

 private:
  Vector3d incisor_mm(double time_s) const {
    return displacement_mm(jaw_.pose_at(time_s), jaw_.landmarks().incisor_lower);
  }
  Vector3d condyle_mm(JawSide side, double time_s) const {
    const JawLandmarks& points = jaw_.landmarks();
    return displacement_mm(jaw_.pose_at(time_s),
                           side == JawSide::left ? points.condyle_left : points.condyle_right);
  }
  double incisor_speed_mm_s(double time_s) const {
    constexpr double h_s = 1e-4;
    return (incisor_mm(time_s + h_s) - incisor_mm(time_s - h_s)).norm() / (2 * h_s);
  }
  void add(const std::string& reading, double value, const char* unit,
           JawSide side = JawSide::none) {
    readings_.push_back({task_, jaw_side_name(side), stroke_, reading, value, unit});
  }

  void read_stroke(const JawStroke& stroke) {
    task_ = jaw_task_name(stroke.kind);
    stroke_ = stroke.stroke;
    const Span out{stroke.begin_s, stroke.outward_end_s}, back{stroke.return_begin_s, stroke.end_s};
    const Span whole{stroke.begin_s, stroke.end_s};
    switch (stroke.kind) {
      case JawTaskKind::opening:
        add("opening_mm", greatest([this](double t) { return incisor_mm(t).norm(); }, whole), "mm");
        add("opening_vertical_mm", greatest([this](double t) { return -incisor_mm(t).z(); }, whole),
            "mm");
        add("opening_angle_deg",
            greatest([this](double t) { return opening_angle_deg(jaw_.pose_at(t).rotation); },
                     whole),
            "deg");
        add("opening_peak_speed_mm_s",
            greatest([this](double t) { return incisor_speed_mm_s(t); }, out), "mm/s");
        add("closing_peak_speed_mm_s",
            greatest([this](double t) { return incisor_speed_mm_s(t); }, back), "mm/s");
        break;
      case JawTaskKind::protrusion:
        add("protrusion_mm", greatest([this](double t) { return incisor_mm(t).x(); }, whole), "mm");
        break;
      default: {
        const bool is_left = stroke.kind == JawTaskKind::left;
        const double sign = is_left ? 1 : -1;
        add("laterotrusion_mm", greatest([&](double t) { return sign * incisor_mm(t).y(); }, whole),
            "mm", is_left ? JawSide::left : JawSide::right);
        const JawSide orbiting = is_left ? JawSide::right : JawSide::left;
        read_condyle(orbiting, out);
        read_medial_path(orbiting, out);
        return;
      }
    }
    for (const JawSide side : {JawSide::left, JawSide::right}) read_condyle(side, out);
  }

  // Path, translation and inclinations of the outward stroke.
  void read_condyle(JawSide side, const Span& out) {
    const auto travel_mm = [this, side](double time_s) {
      const Vector3d c = condyle_mm(side, time_s);
      return std::sqrt(c.x() * c.x() + c.z() * c.z());
    };
    add("condylar_translation_mm",
        greatest([&](double t) { return condyle_mm(side, t).norm(); }, out), "mm", side);
    if (const auto start_s = first_passage_s(travel_mm, out, kPathStart_mm)) {
      double path_mm = 0;
      Vector3d last = condyle_mm(side, *start_s);
      at_instants({*start_s, greatest_at_s(travel_mm, out)}, [&](double time_s) {
        const Vector3d now = condyle_mm(side, time_s);
        path_mm += (now - last).norm();
        last = now;
      });
      add("condylar_path_mm", path_mm, "mm", side);
    }
    for (const double at_mm : kTravels_mm) {
      const auto time_s = first_passage_s(travel_mm, out, at_mm);
      if (!time_s) continue;
      const Vector3d c = condyle_mm(side, *time_s);
      add(fmt::format("condylar_inclination_{:g}mm_deg", at_mm),
          kDegrees * std::atan2(-c.z(), c.x()), "deg", side);
    }
  }

  // Bennett angles and side shift of the orbiting condyle.
  void read_medial_path(JawSide side, const Span& out) {
    const double inwards = side == JawSide::left ? -1 : 1;
    const auto travel_mm = [this, side](double time_s) {
      const Vector3d c = condyle_mm(side, time_s);
      return std::sqrt(c.x() * c.x() + c.z() * c.z());
    };
    for (const double at_mm : kTravels_mm) {
      const auto time_s = first_passage_s(travel_mm, out, at_mm);
      if (!time_s) continue;
      const Vector3d c = condyle_mm(side, *time_s);
      add(fmt::format("bennett_angle_{:g}mm_deg", at_mm),
          kDegrees * std::atan2(inwards * c.y(), c.x()), "deg", side);
    }
    double from_s = out.begin_s;  // x is asked for in rising order
    const auto medial_mm = [&](double x_mm) -> std::optional<double> {
      const auto time_s = first_passage_s([&](double t) { return condyle_mm(side, t).x(); },
                                          {from_s, out.end_s}, x_mm);
      if (!time_s) return std::nullopt;
      from_s = *time_s;
      return inwards * condyle_mm(side, *time_s).y();
    };
    if (const auto early_mm = medial_mm(kEarlyShift_mm)) {
      add("side_shift_05mm_mm", *early_mm, "mm", side);
    }
    double n = 0, sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
    const auto points = std::lround((kShiftEnd_mm - kShiftStart_mm) / kShiftStep_mm);
    for (long i = 0; i <= points; ++i) {
      const double x_mm = kShiftStart_mm + kShiftStep_mm * static_cast<double>(i);
      const auto y_mm = medial_mm(x_mm);
      if (!y_mm) return;
      n += 1;
      sum_x += x_mm;
      sum_y += *y_mm;
      sum_xx += x_mm * x_mm;
      sum_xy += x_mm * *y_mm;
    }
    const double slope = (n * sum_xy - sum_x * sum_y) / (n * sum_xx - sum_x * sum_x);
    add("side_shift_mm", (sum_y - slope * sum_x) / n, "mm", side);
    add("progressive_side_shift_deg", kDegrees * std::atan(slope), "deg", side);
  }

  void read_cycles() {
    const std::vector<JawCycle> cycles = true_cycles(jaw_);
    if (cycles.empty()) return;
    const TruthOfCycles truth(jaw_, cycles);
    task_ = jaw_task_name(JawTaskKind::chewing);
    for (const TrueCycle& cycle : truth.cycles()) {
      stroke_ = cycle.number;
      for (const TrueCycleValue& value : cycle.values) add(value.reading, value.value, value.unit);
    }
    stroke_ = 0;
    for (const TrueCycleValue& value : truth.summary()) {
      add(value.reading, value.value, value.unit, value.side);
    }
  }

  // Stroke 0 of everything that was read stroke by stroke.
  void add_means() {
    std::vector<TrueReading> means;
    std::vector<int> counts;
    for (const TrueReading& one : readings_) {
      if (one.stroke == 0) continue;
      const auto same = [&one](const TrueReading& mean) {
        return mean.task == one.task && mean.side == one.side && mean.reading == one.reading;
      };
      const auto found = std::find_if(means.begin(), means.end(), same);
      if (found == means.end()) {
        means.push_back(one);
        means.back().stroke = 0;
        counts.push_back(1);
      } else {
        found->value += one.value;
        ++counts[static_cast<std::size_t>(found - means.begin())];
      }
    }
    for (std::size_t i = 0; i < means.size(); ++i) means[i].value /= counts[i];
    readings_.insert(readings_.end(), means.begin(), means.end());
  }

  void read_task(const JawTaskSpan& task) {
    task_ = task.name();
    stroke_ = 0;
    const Span span{task.begin_s, task.end_s};
    add("rotation_deg",
        greatest([this](double t) { return rotation_angle_deg(jaw_.pose_at(t).rotation); }, span),
        "deg");
    add("displacement_mm", greatest([this](double t) { return incisor_mm(t).norm(); }, span), "mm");
  }

  std::optional<double> inclination_5mm_deg(JawTaskKind task, JawSide side) const {
    for (const TrueReading& one : readings_) {
      if (one.task == jaw_task_name(task) && one.side == jaw_side_name(side) && one.stroke == 0 &&
          one.reading == "condylar_inclination_5mm_deg") {
        return one.value;
      }
    }
    return std::nullopt;
  }

  void add_fischer_angles() {
    stroke_ = 0;
    for (const JawSide side : {JawSide::left, JawSide::right}) {
      const JawTaskKind mediotrusion =
          side == JawSide::left ? JawTaskKind::right : JawTaskKind::left;
      const auto lateral_deg = inclination_5mm_deg(mediotrusion, side);
      const auto protrusive_deg = inclination_5mm_deg(JawTaskKind::protrusion, side);
      if (!lateral_deg || !protrusive_deg) continue;
      task_ = jaw_task_name(mediotrusion);
      add("fischer_angle_5mm_deg", *lateral_deg - *protrusive_deg, "deg", side);
    }
  }

  const KinematicJaw& jaw_;
  std::string task_;
  int stroke_ = 0;
  std::vector<TrueReading> readings_;
};

}  // namespace

std::vector<TrueReading> true_readings(const KinematicJaw& jaw) {
  return TruthOfJaw(jaw).read();
}

}  // namespace condyle::host
