// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/true_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "simulation/kinematic/true_axes.h"
#include "simulation/kinematic/true_border.h"
#include "simulation/kinematic/true_cycles.h"
#include "simulation/kinematic/true_measures.h"

namespace condyle::host {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using namespace truth;

constexpr double kPathStart_mm = 0.3;                   // of travel
constexpr double kChord_mm = 0.5;                       // of the path's length
constexpr double kTravels_mm[] = {3, 5, 10};            // of the angles
constexpr double kShiftStart_mm = 2, kShiftEnd_mm = 5;  // of the fit, in x
constexpr int kShiftSteps = 60;
constexpr double kLeastSpeedShare = 0.05;  // of the peak: begin and end of a movement
constexpr double kEarlyShift_mm = 0.5;     // x at which side_shift_05mm is read

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
    add_kinematic_centres();
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
    return speed_mm_s([this](double t) { return incisor_mm(t); }, time_s);
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
    add_greatest(whole);
    const auto speed = [this](double t) { return incisor_speed_mm_s(t); };
    const TrueSmoothness there = smoothness(speed, out, kLeastSpeedShare);
    const TrueSmoothness home = smoothness(speed, back, kLeastSpeedShare);
    add("sparc", there.sparc, "1");
    add("ldlj", there.ldlj, "1");
    add("closing_sparc", home.sparc, "1");
    add("closing_ldlj", home.ldlj, "1");
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
        read_aside(whole);
        for (const TrueAxisValue& one : true_axes(jaw_, out)) add(one.reading, one.value_mm, "mm");
        break;
      case JawTaskKind::protrusion:
        add("protrusion_mm", greatest([this](double t) { return incisor_mm(t).x(); }, whole), "mm");
        break;
      default: {
        const bool is_left = stroke.kind == JawTaskKind::left;
        const double sign = is_left ? 1 : -1;
        add("laterotrusion_mm", greatest([&](double t) { return sign * incisor_mm(t).y(); }, whole),
            "mm", is_left ? JawSide::left : JawSide::right);
        add("yaw_angle_deg",
            greatest(
                [&](double t) {
                  const Matrix3d R = jaw_.pose_at(t).rotation;  // 4 q_w q_z = R_21 - R_12
                  return 2 * kDegrees * sign * std::atan2(R(1, 0) - R(0, 1), 1 + R.trace());
                },
                whole),
            "deg", is_left ? JawSide::left : JawSide::right);
        const JawSide orbiting = is_left ? JawSide::right : JawSide::left;
        read_condyle(orbiting, out, back);
        read_medial_path(orbiting, out);
        read_working(is_left ? JawSide::left : JawSide::right, whole);
        return;
      }
    }
    const double left_mm = read_condyle(JawSide::left, out, back);
    const double right_mm = read_condyle(JawSide::right, out, back);
    add("condylar_path_difference_mm", left_mm - right_mm, "mm");
    const auto translation_mm = [&](JawSide side) {
      return greatest([&](double t) { return condyle_mm(side, t).norm(); }, out);
    };
    add("condylar_translation_difference_mm",
        translation_mm(JawSide::left) - translation_mm(JawSide::right), "mm");
    if (stroke.kind != JawTaskKind::opening) return;
    for (const JawSide side : {JawSide::left, JawSide::right}) read_rotation(side, out);
  }

  // Deflection and deviation of the way to the greatest opening.
  void read_aside(const Span& whole) {
    const double open_s = greatest_at_s([this](double t) { return incisor_mm(t).norm(); }, whole);
    const Vector3d begin = incisor_mm(whole.begin_s), open = incisor_mm(open_s);
    add("opening_deflection_mm", open.y(), "mm");
    const Vector3d chord = open - begin;
    const auto aside_mm = [&](double t) {
      const Vector3d now = incisor_mm(t) - begin;
      return now.y() - now.z() / chord.z() * chord.y();
    };
    const Span way{whole.begin_s, open_s};
    const double leftmost = greatest(aside_mm, way);
    const double rightmost = greatest([&](double t) { return -aside_mm(t); }, way);
    add("opening_deviation_mm", leftmost > rightmost ? leftmost : -rightmost, "mm");
  }

  // Degrees of opening a millimetre, between two shares of the greatest travel.
  void read_rotation(JawSide side, const Span& out) {
    const auto travel_mm = [this, side](double time_s) {
      const Vector3d c = condyle_mm(side, time_s);
      return std::sqrt(c.x() * c.x() + c.z() * c.z());
    };
    const double most_mm = greatest(travel_mm, out);
    const auto from_s = first_passage_s(travel_mm, out, 0.2 * most_mm);
    const auto to_s = first_passage_s(travel_mm, out, 0.8 * most_mm);
    if (!from_s || !to_s) return;
    add("rotation_per_translation_deg_mm",
        (opening_angle_deg(jaw_.pose_at(*to_s).rotation) -
         opening_angle_deg(jaw_.pose_at(*from_s).rotation)) /
            (0.6 * most_mm),
        "deg/mm", side);
  }

  // Of the working condyle, where the incisor is furthest to its side.
  void read_working(JawSide side, const Span& whole) {
    const double outwards = side == JawSide::left ? 1 : -1;
    const double at_s =
        greatest_at_s([&](double t) { return outwards * incisor_mm(t).y(); }, whole);
    const Vector3d c = condyle_mm(side, at_s);
    add("working_shift_mm", outwards * c.y(), "mm", side);
    add("working_shift_angle_deg", kDegrees * std::atan2(c.x(), outwards * c.y()), "deg", side);
  }

  // Path, which is returned (mm), translation and inclinations of the outward stroke.
  double read_condyle(JawSide side, const Span& out, const Span& back) {
    const auto travel_mm = [this, side](double time_s) {
      const Vector3d c = condyle_mm(side, time_s);
      return std::sqrt(c.x() * c.x() + c.z() * c.z());
    };
    add("condylar_translation_mm",
        greatest([&](double t) { return condyle_mm(side, t).norm(); }, out), "mm", side);
    double path_mm = 0;
    if (const auto start_s = first_passage_s(travel_mm, out, kPathStart_mm)) {
      // By chords of this length; the last one is shorter.
      double from_s = *start_s;
      const double end_s = greatest_at_s(travel_mm, out);
      const auto chord_mm = [&](double t) {
        return (condyle_mm(side, t) - condyle_mm(side, from_s)).norm();
      };
      while (const auto next_s = first_passage_s(chord_mm, {from_s, end_s}, kChord_mm)) {
        path_mm += kChord_mm;
        from_s = *next_s;
      }
      path_mm += chord_mm(end_s);
      add("condylar_path_mm", path_mm, "mm", side);
    }
    for (const double at_mm : kTravels_mm) {
      const auto time_s = first_passage_s(travel_mm, out, at_mm);
      if (!time_s) continue;
      const Vector3d c = condyle_mm(side, *time_s);
      add(fmt::format("condylar_inclination_{:g}mm_deg", at_mm),
          kDegrees * std::atan2(-c.z(), c.x()), "deg", side);
    }
    const auto place_mm = [this, side](double t) { return condyle_mm(side, t); };
    add("condylar_peak_speed_mm_s",
        greatest([&](double t) { return speed_mm_s(place_mm, t); }, out), "mm/s", side);
    const auto inclination_rad = [&](double time_s) {
      const Vector3d c = condyle_mm(side, time_s);
      return std::atan2(-c.z(), c.x());
    };
    const double most_mm = greatest(travel_mm, out);
    double apart_mm = 0;
    for (int i = 0; i < 8; ++i) {
      const double at_mm = (0.2 + 0.1 * i) * most_mm;
      const auto out_s = first_passage_s(travel_mm, out, at_mm);
      const auto back_s = first_passage_s([&](double t) { return -travel_mm(t); }, back, -at_mm);
      if (!out_s || !back_s) return path_mm;
      apart_mm += std::abs(inclination_rad(*back_s) - inclination_rad(*out_s)) * at_mm / 8;
    }
    add("condylar_separation_mm", apart_mm, "mm", side);
    return path_mm;
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
    // Least squares of y = a + b u over u = x - middle: a = mean of y, b = mean of u y over that of
    // u^2. Means by Simpson's rule.
    constexpr double half_mm = (kShiftEnd_mm - kShiftStart_mm) / 2;
    double mean_y = 0, mean_uy = 0;
    for (int i = 0; i <= kShiftSteps; ++i) {
      const double u_mm = half_mm * (2.0 * i / kShiftSteps - 1);
      const auto y_mm = medial_mm(kShiftStart_mm + half_mm + u_mm);
      if (!y_mm) return;
      const double weight =
          (i == 0 || i == kShiftSteps ? 1 : 2 + 2 * (i % 2)) / (3.0 * kShiftSteps);
      mean_y += weight * *y_mm;
      mean_uy += weight * u_mm * *y_mm;
    }
    const double slope = mean_uy / (half_mm * half_mm / 3);
    add("side_shift_mm", mean_y - slope * (kShiftStart_mm + half_mm), "mm", side);
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

  // In a stroke, or in a task without strokes.
  void add_greatest(const Span& span) {
    add("rotation_deg",
        greatest([this](double t) { return rotation_angle_deg(jaw_.pose_at(t).rotation); }, span),
        "deg");
    add("displacement_mm", greatest([this](double t) { return incisor_mm(t).norm(); }, span), "mm");
  }

  void read_task(const JawTaskSpan& task) {
    task_ = task.name();
    stroke_ = 0;
    const Span span{task.begin_s, task.end_s};
    const bool has_strokes = task.kind == JawTaskKind::opening ||
                             task.kind == JawTaskKind::protrusion ||
                             task.kind == JawTaskKind::left || task.kind == JawTaskKind::right;
    if (!has_strokes) add_greatest(span);
    if (task.kind != JawTaskKind::border) return;
    for (const TrueBorderValue& one :
         true_border([this](double t) { return incisor_mm(t); }, span)) {
      add(one.reading, one.value, one.unit);
    }
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

  // In opening and protrusion a condylar point follows the same curve, and no other point does.
  void add_kinematic_centres() {
    int strokes[2] = {};
    for (const JawStroke& stroke : jaw_.motion().strokes()) {
      strokes[0] += stroke.kind == JawTaskKind::opening;
      strokes[1] += stroke.kind == JawTaskKind::protrusion;
    }
    if (strokes[0] == 0 || strokes[1] == 0) return;
    task_ = jaw_task_name(JawTaskKind::protrusion);
    stroke_ = 0;
    for (const JawSide side : {JawSide::left, JawSide::right}) {
      add("kinematic_centre_x_mm", 0, "mm", side);
      add("kinematic_centre_z_mm", 0, "mm", side);
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
