// SPDX-License-Identifier: Apache-2.0
#include "readings/stroke_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "readings/path_measures.h"
#include "readings/smoothness.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr double kNone = JawReading::kNone;
constexpr double kDegree = std::numbers::pi / 180, kMillimetre = 1e-3;
constexpr double kOnset_m = 0.3e-3;        // travel of a condyle that has left the fossa
constexpr double kChord_m = 0.5e-3;        // of a path's length
constexpr double kTopReach_s = 0.12;       // of a stroke's turning point
constexpr double kLeastSpeedShare = 0.05;  // of the peak: begin and end of a movement
constexpr double kLeastAxisAngle_rad = 5 * kDegree, kHingeArc_rad = 12 * kDegree;

// The reading that is being made: values go in the order of readings_of_stroke.
class Values {
 public:
  Values(std::vector<double>& values, std::vector<std::string>* why) : values_(values), why_(why) {
    values_.clear();
    if (why_ != nullptr) why_->clear();
  }
  template <class Reason>
  void add(double value, const Reason& reason) {
    values_.push_back(value);
    if (why_ != nullptr) why_->push_back(std::isfinite(value) ? std::string() : reason());
  }
  void add(double value) {
    add(value, [] { return std::string("it could not be computed"); });
  }

 private:
  std::vector<double>& values_;
  std::vector<std::string>* why_;
};

std::vector<double> sizes_of(const Points& points) {
  std::vector<double> sizes;
  sizes.reserve(points.size());
  for (const Vector3d& point : points) sizes.push_back(point.norm());
  return sizes;
}

std::vector<double> coordinate_of(const Points& points, int axis, double sign) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Vector3d& point : points) values.push_back(sign * point[axis]);
  return values;
}

double greatest_mm(const JawPath& path, const std::vector<double>& values_m) {
  return greatest_of(path.time_s, values_m, 0, values_m.size(), kTopReach_s).value / kMillimetre;
}

// Speed from `begin` to `end` (without): its peak, and the movement around the peak.
struct Movement {
  double peak_m_s = 0, step_s = 0;
  std::vector<double> speed_m_s;
};

Movement movement_of(const JawPath& path, const std::vector<double>& speeds, std::size_t begin,
                     std::size_t end) {
  Movement movement;
  const Greatest peak = greatest_of(path.time_s, speeds, begin, end, kTopReach_s);
  const std::size_t at = peak.at;
  movement.peak_m_s = peak.value;
  std::size_t first = at, last = at;
  const double least = kLeastSpeedShare * movement.peak_m_s;
  while (first > begin && speeds[first - 1] >= least) --first;
  while (last + 1 < end && speeds[last + 1] >= least) ++last;
  movement.speed_m_s.assign(speeds.begin() + static_cast<std::ptrdiff_t>(first),
                            speeds.begin() + static_cast<std::ptrdiff_t>(last + 1));
  movement.step_s =
      last > first ? (path.time_s[last] - path.time_s[first]) / static_cast<double>(last - first)
                   : 0;
  return movement;
}

// The outward path of a condyle: from kOnset_m to the greatest sagittal travel.
struct Outward {
  std::size_t begin = 0, end = 0;
  double travel_m = 0;
};

// Its length, from the very passage of kOnset_m.
double outward_length_m(const JawPath& path, std::size_t side, const Outward& outward);

double sagittal(const Vector3d& point) {
  return std::hypot(point.x(), point.z());
}

Outward outward_of(const std::vector<double>& time_s, const Points& condyle_m) {
  std::vector<double> travels;
  for (const Vector3d& point : condyle_m) travels.push_back(sagittal(point));
  const Greatest greatest = greatest_of(time_s, travels, 0, travels.size(), kTopReach_s);
  Outward outward{greatest.at, greatest.at, greatest.value};
  while (outward.begin > 0 && sagittal(condyle_m[outward.begin]) > kOnset_m) --outward.begin;
  return outward;
}

double outward_length_m(const JawPath& path, std::size_t side, const Outward& outward) {
  if (outward.travel_m < kOnset_m || outward.end == 0) return kNone;
  Points points = path.condyle_m[side];
  const auto onset = first_passage(path.time_s, points, path.condyle_m_s[side], outward.begin,
                                   outward.begin + 1, kOnset_m, sagittal);
  if (onset) points[outward.begin] = onset->point;
  const double beyond_m = outward.travel_m - sagittal(points[outward.end]);
  return path_length_m(points, outward.begin, outward.end, kChord_m) + beyond_m;
}

double medial(const Vector3d& point, std::size_t side) {
  return side == 0 ? -point.y() : point.y();
}

void add_inclinations(const JawPath& path, std::size_t side, const Outward& outward, bool bennett,
                      Values& out) {
  for (const double travel_mm : {3.0, 5.0, 10.0}) {
    const auto at = first_passage(path.time_s, path.condyle_m[side], path.condyle_m_s[side],
                                  outward.begin, outward.end, travel_mm * kMillimetre, sagittal);
    const auto reason = [&] {
      return fmt::format("the condyle travels {:.1f} mm, not {:g} mm",
                         outward.travel_m / kMillimetre, travel_mm);
    };
    out.add(at ? std::atan2(-at->point.z(), at->point.x()) / kDegree : kNone, reason);
    if (bennett) {
      out.add(at ? std::atan2(medial(at->point, side), at->point.x()) / kDegree : kNone, reason);
    }
  }
}

void add_side_shift(const JawPath& path, std::size_t side, const Outward& outward, Values& out) {
  const auto forward = [](const Vector3d& point) { return point.x(); };
  const auto at = [&](double x_mm) {
    return first_passage(path.time_s, path.condyle_m[side], path.condyle_m_s[side], outward.begin,
                         outward.end, x_mm * kMillimetre, forward);
  };
  constexpr int kSteps = 30;
  double sum = 0, sum_x = 0, sum_xx = 0, sum_y = 0, sum_xy = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double x_mm = 2 + 3.0 * i / kSteps;
    const auto point = at(x_mm);
    if (!point) break;
    const double y_mm = medial(point->point, side) / kMillimetre;
    ++sum;
    sum_x += x_mm;
    sum_xx += x_mm * x_mm;
    sum_y += y_mm;
    sum_xy += x_mm * y_mm;
  }
  double a = kNone, b = kNone;
  if (sum > kSteps) {
    b = (sum * sum_xy - sum_x * sum_y) / (sum * sum_xx - sum_x * sum_x);
    a = (sum_y - b * sum_x) / sum;
  }
  const auto reason = [] { return std::string("the condyle moves less than 5 mm forward"); };
  out.add(a, reason);
  const auto early = at(0.5);
  out.add(early ? medial(early->point, side) / kMillimetre : kNone, reason);
  out.add(std::atan(b) / kDegree, reason);
}

void add_condyles(TaskKind kind, const JawPath& path, Values& out) {
  double length_mm[2];
  for (std::size_t side = 0; side < 2; ++side) {
    const Outward outward = outward_of(path.time_s, path.condyle_m[side]);
    length_mm[side] = outward_length_m(path, side, outward) / kMillimetre;
    out.add(length_mm[side], [] { return std::string("the condyle travels less than 0.3 mm"); });
    out.add(greatest_mm(path, sizes_of(path.condyle_m[side])));
    const bool orbits =
        (kind == TaskKind::left && side == 1) || (kind == TaskKind::right && side == 0);
    if (kind == TaskKind::opening || kind == TaskKind::protrusion || orbits) {
      add_inclinations(path, side, outward, orbits, out);
    }
    if (orbits) add_side_shift(path, side, outward, out);
  }
  out.add(length_mm[0] - length_mm[1]);
}

void add_condyle_names(TaskKind kind, std::vector<StrokeReading>& names) {
  for (const Side side : {Side::left, Side::right}) {
    names.push_back({"condylar_path_mm", side});
    names.push_back({"condylar_translation_mm", side});
    const bool orbits = (kind == TaskKind::left && side == Side::right) ||
                        (kind == TaskKind::right && side == Side::left);
    if (kind == TaskKind::opening || kind == TaskKind::protrusion || orbits) {
      for (const auto& [inclination, bennett] :
           {std::pair("condylar_inclination_3mm_deg", "bennett_angle_3mm_deg"),
            std::pair("condylar_inclination_5mm_deg", "bennett_angle_5mm_deg"),
            std::pair("condylar_inclination_10mm_deg", "bennett_angle_10mm_deg")}) {
        names.push_back({inclination, side});
        if (orbits) names.push_back({bennett, side});
      }
    }
    if (!orbits) continue;
    names.push_back({"side_shift_mm", side});
    names.push_back({"side_shift_05mm_mm", side});
    names.push_back({"progressive_side_shift_deg", side});
  }
  names.push_back({"condylar_path_difference_mm", Side::none});
}

void add_axes(const JawPath& path, const std::vector<double>& angles, std::size_t widest,
              Values& out) {
  Vector3d crossing = Vector3d::Constant(kNone);
  const auto too_little = [&] {
    return fmt::format("the jaw turns by {:.1f} deg, at least {:.0f} deg are needed",
                       angles[widest] / kDegree, kLeastAxisAngle_rad / kDegree);
  };
  if (angles[widest] >= kLeastAxisAngle_rad) {
    // The beginning of the opening, as far as the hinge phase goes.
    std::size_t first = widest, last = widest;
    while (first > 0 && angles[first] > 0.2 * kLeastAxisAngle_rad) --first;
    for (std::size_t k = first; k <= widest; ++k) {
      if (angles[k] < kHingeArc_rad) continue;
      last = k;
      break;
    }
    const auto hinge = hinge_axis_crossing_m(path, first, last);
    if (hinge) crossing = *hinge;
  }
  out.add(crossing.x() / kMillimetre, too_little);
  out.add(crossing.z() / kMillimetre, too_little);
  crossing = Vector3d::Constant(kNone);
  if (angles[widest] >= kLeastAxisAngle_rad) {
    const HelicalAxis axis =
        helical_axis(path.rotation_rad[widest], path.middle_at_m, path.middle_m[widest]);
    if (std::abs(axis.direction.y()) > 0.5) {
      crossing = axis.point_m - axis.direction * (axis.point_m.y() / axis.direction.y());
    }
  }
  out.add(crossing.x() / kMillimetre, too_little);
  out.add(crossing.z() / kMillimetre, too_little);
}

void add_opening(const JawPath& path, std::size_t turn, Values& out) {
  out.add(greatest_mm(path, sizes_of(path.incisor_m)));
  out.add(greatest_mm(path, coordinate_of(path.incisor_m, 2, -1)));
  std::vector<double> twists;
  for (const Vector3d& w : path.rotation_rad) twists.push_back(twist_about(w, 1));
  const Greatest twist = greatest_of(path.time_s, twists, 0, twists.size(), kTopReach_s);
  const std::size_t widest = twist.at;
  out.add(twist.value / kDegree);
  out.add(path.incisor_m[turn].y() / kMillimetre);
  double deviation_m = 0;
  const Vector3d chord = path.incisor_m[turn] - path.incisor_m[0];
  for (std::size_t k = 0; k <= turn; ++k) {
    // Sideways of the chord, at the same height.
    const double share =
        chord.z() != 0 ? (path.incisor_m[k].z() - path.incisor_m[0].z()) / chord.z() : 0;
    const double aside_m = path.incisor_m[k].y() - path.incisor_m[0].y() - share * chord.y();
    if (std::abs(aside_m) > std::abs(deviation_m)) deviation_m = aside_m;
  }
  out.add(deviation_m / kMillimetre);
  add_axes(path, twists, widest, out);
}

void add_speeds(const JawPath& path, std::size_t turn, Values& out) {
  const std::vector<double> speeds = sizes_of(path.incisor_m_s);
  for (int back = 0; back < 2; ++back) {
    const std::size_t begin = back == 1 ? turn : 0;
    const std::size_t end = back == 1 ? path.time_s.size() : turn + 1;
    if (end - begin < 5) {
      for (int i = 0; i < 3; ++i) {
        out.add(kNone, [&] {
          return std::string(back == 1 ? "the way back is not recorded"
                                       : "the way out is not recorded");
        });
      }
      continue;
    }
    const Movement movement = movement_of(path, speeds, begin, end);
    out.add(movement.peak_m_s / kMillimetre);
    out.add(spectral_arc_length(movement.speed_m_s, movement.step_s));
    out.add(log_dimensionless_jerk(movement.speed_m_s, movement.step_s));
  }
}

}  // namespace

std::vector<StrokeReading> readings_of_stroke(TaskKind kind, bool has_landmarks) {
  std::vector<StrokeReading> names = {{"displacement_mm"}, {"rotation_deg"}};
  if (kind == TaskKind::rest || kind == TaskKind::whole) return names;
  if (kind == TaskKind::border) {
    if (has_landmarks) {
      for (const char* name :
           {"border_area_sagittal_mm2", "border_area_frontal_mm2", "border_area_horizontal_mm2"}) {
        names.push_back({name});
      }
    }
    return names;
  }
  for (const char* name : {"opening_peak_speed_mm_s", "sparc", "ldlj", "closing_peak_speed_mm_s",
                           "closing_sparc", "closing_ldlj"}) {
    names.push_back({name});
  }
  if (!has_landmarks) {
    if (kind == TaskKind::opening) names.push_back({"opening_mm"});
    return names;
  }
  if (kind == TaskKind::opening) {
    for (const char* name : {"opening_mm", "opening_vertical_mm", "opening_angle_deg",
                             "opening_deflection_mm", "opening_deviation_mm", "hinge_axis_x_mm",
                             "hinge_axis_z_mm", "helical_axis_x_mm", "helical_axis_z_mm"}) {
      names.push_back({name});
    }
  }
  if (kind == TaskKind::protrusion) names.push_back({"protrusion_mm"});
  if (kind == TaskKind::left || kind == TaskKind::right) {
    const bool is_left = kind == TaskKind::left;
    names.push_back({"laterotrusion_mm", is_left ? Side::left : Side::right});
    names.push_back({"working_shift_mm", is_left ? Side::left : Side::right});
  }
  add_condyle_names(kind, names);
  return names;
}

void read_stroke(TaskKind kind, bool has_landmarks, const JawPath& path,
                 std::vector<double>& values, std::vector<std::string>* why) {
  Values out(values, why);
  const std::vector<double> distances = sizes_of(path.incisor_m);
  const Greatest farthest = greatest_of(path.time_s, distances, 0, distances.size(), kTopReach_s);
  const std::size_t turn = farthest.at;
  out.add(farthest.value / kMillimetre);
  const std::vector<double> angles = sizes_of(path.rotation_rad);
  out.add(greatest_of(path.time_s, angles, 0, angles.size(), kTopReach_s).value / kDegree);
  if (kind == TaskKind::rest || kind == TaskKind::whole) return;
  if (kind == TaskKind::border) {
    if (!has_landmarks) return;
    out.add(hull_area(path.incisor_m, 0, 2) * 1e6);
    out.add(hull_area(path.incisor_m, 1, 2) * 1e6);
    out.add(hull_area(path.incisor_m, 0, 1) * 1e6);
    return;
  }
  add_speeds(path, turn, out);
  if (!has_landmarks) {
    if (kind == TaskKind::opening) {
      out.add(kNone,
              [] { return std::string("the lower incisor is not known; give --landmarks"); });
    }
    return;
  }
  if (kind == TaskKind::opening) add_opening(path, turn, out);
  if (kind == TaskKind::protrusion) {
    out.add(greatest_mm(path, coordinate_of(path.incisor_m, 0, 1)));
  }
  if (kind == TaskKind::left || kind == TaskKind::right) {
    const bool is_left = kind == TaskKind::left;
    const std::vector<double> aside = coordinate_of(path.incisor_m, 1, is_left ? 1 : -1);
    const Greatest farthest_aside = greatest_of(path.time_s, aside, 0, aside.size(), kTopReach_s);
    out.add(farthest_aside.value / kMillimetre);
    const std::size_t side = is_left ? 0 : 1;
    const std::size_t at = farthest_aside.at;
    out.add(-medial(path.condyle_m[side][at], side) / kMillimetre);
  }
  add_condyles(kind, path, out);
}

}  // namespace condyle::host
