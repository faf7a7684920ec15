// SPDX-License-Identifier: Apache-2.0
#include "readings/condyle_readings.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "readings/reading_groups.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr double kNone = JawReading::kNone;
constexpr double kDegree = std::numbers::pi / 180, kMillimetre = 1e-3;
constexpr double kOnset_m = 0.3e-3;  // travel of a condyle that has left the fossa
constexpr double kChord_m = 0.5e-3;  // of a path's length
// How far below the highest the greatest travel may lie, as a multiple of its roughness there:
// noise or tremor, of which the highest sample is one end.
constexpr double kRough = 6;
// Paths that are nearer to each other coincide.
constexpr double kLeastSeparation_mm = 0.05;
constexpr std::size_t kEnds = 20;
constexpr double kLeastTravelShare = 0.2, kMostTravelShare = 0.9;  // of separations
constexpr double kSlopeFrom = 0.2, kSlopeTo = 0.8;                 // the middle 60 % of the travel
constexpr double kLeastSlopeTravel_m = 3e-3;
constexpr double kShiftFrom_mm = 2, kShiftTo_mm = 5;  // x of the line that gives the side shift

// The outward path of a condyle: from kOnset_m to the greatest sagittal travel.
struct Outward {
  std::size_t begin = 0;
  Greatest top{};                 // its end
  std::vector<double> travels_m;  // sagittal, of all samples
};

// Whether the condyle of `side` goes forward in a stroke of `kind`, and whether it orbits.
bool orbits(TaskKind kind, std::size_t side) {
  return (kind == TaskKind::left && side == 1) || (kind == TaskKind::right && side == 0);
}
bool goes_forward(TaskKind kind, std::size_t side) {
  return kind == TaskKind::opening || kind == TaskKind::protrusion || orbits(kind, side);
}

Outward outward_of(const JawPath& path, std::size_t side) {
  Outward outward;
  outward.travels_m = sagittal_sizes_of(path.condyle_m[side]);
  const std::vector<double>& travels_m = outward.travels_m;
  outward.top = greatest_of(path.time_s, travels_m, 0, travels_m.size(), top_reach_s(path));
  outward.begin = outward.top.at;
  while (outward.begin > 0 && travels_m[outward.begin] > kOnset_m) --outward.begin;
  return outward;
}

// The length of the path to each sample, from the last passage of kOnset_m before it; 0 while the
// condyle is within kOnset_m.
std::vector<double> outward_lengths_m(const JawPath& path, std::size_t side) {
  const Points& condyle_m = path.condyle_m[side];
  std::vector<double> lengths_m;
  lengths_m.reserve(condyle_m.size());
  PathLength length(kChord_m);
  for (std::size_t k = 0; k < condyle_m.size(); ++k) {
    const bool is_within = sagittal_size(condyle_m[k]) <= kOnset_m;
    if (k == 0 || is_within) {
      length.begin(condyle_m[k]);
    } else if (sagittal_size(condyle_m[k - 1]) <= kOnset_m) {
      const auto onset = first_passage(path.time_s, condyle_m, path.condyle_m_s[side], k - 1, k,
                                       kOnset_m, sagittal_size);
      if (onset) length.begin(onset->point);
    }
    if (k > 0 && !is_within) length.add(condyle_m[k]);
    lengths_m.push_back(length.length_m());
  }
  return lengths_m;
}

// The path's length, and how far it differs at samples whose travel may be the greatest (mm).
struct PathReading {
  double length_mm, difference_mm;
};

// While the travel hardly changes, the path may become longer: the condyle goes aside or trembles.
PathReading add_path(const JawPath& path, std::size_t side, const Outward& outward,
                     ReadingValues& out) {
  const Greatest& top = outward.top;
  const std::vector<double> lengths_m = outward_lengths_m(path, side);
  const bool is_out = top.value >= kOnset_m && top.at > 0;
  const double beyond_m = top.value - outward.travels_m[top.at];
  const auto length_mm = [&](std::size_t k) {
    return is_out ? (lengths_m[k] + beyond_m) / kMillimetre : kNone;
  };
  const double difference_mm = out.add_at_top(
      top, outward.travels_m, length_mm,
      [] { return std::string("the condyle travels less than 0.3 mm"); },
      kRough * roughness_of(path.time_s, outward.travels_m, top, top_reach_s(path)));
  return {length_mm(top.at), difference_mm};
}

void add_inclinations(const JawPath& path, std::size_t side, const Outward& outward, bool bennett,
                      ReadingValues& out) {
  for (const double travel_mm : {3.0, 5.0, 10.0}) {
    const auto at =
        first_passage(path.time_s, path.condyle_m[side], path.condyle_m_s[side], outward.begin,
                      outward.top.at, travel_mm * kMillimetre, sagittal_size);
    const auto reason = [&] {
      return fmt::format("the condyle travels {:.1f} mm, not {:g} mm",
                         outward.top.value / kMillimetre, travel_mm);
    };
    out.add(at ? std::atan2(-at->point.z(), at->point.x()) / kDegree : kNone, reason);
    if (bennett) {
      out.add(at ? std::atan2(medial(at->point, side), at->point.x()) / kDegree : kNone, reason);
    }
  }
}

void add_side_shift(const JawPath& path, std::size_t side, const Outward& outward,
                    ReadingValues& out) {
  const auto forward = [](const Vector3d& point) { return point.x(); };
  const auto at = [&](double x_mm) {
    return first_passage(path.time_s, path.condyle_m[side], path.condyle_m_s[side], outward.begin,
                         outward.top.at, x_mm * kMillimetre, forward);
  };
  // Least squares over all x, by Simpson's rule.
  constexpr int kSteps = 30;
  constexpr double kMiddle_mm = (kShiftFrom_mm + kShiftTo_mm) / 2;
  constexpr double kHalf_mm = (kShiftTo_mm - kShiftFrom_mm) / 2;
  double mean_y = 0, mean_uy = 0;  // u = x - kMiddle_mm
  for (int i = 0; i <= kSteps; ++i) {
    const double u_mm = kHalf_mm * (2.0 * i / kSteps - 1);
    const auto point = at(kMiddle_mm + u_mm);
    const double y_mm = point ? medial(point->point, side) / kMillimetre : kNone;
    const double weight = (i % kSteps == 0 ? 1 : i % 2 == 1 ? 4 : 2) / (3.0 * kSteps);
    mean_y += weight * y_mm;
    mean_uy += weight * u_mm * y_mm;
  }
  const double b = mean_uy / (kHalf_mm * kHalf_mm / 3);
  const double a = mean_y - b * kMiddle_mm;
  const auto reason = [] { return std::string("the condyle moves less than 5 mm forward"); };
  out.add(a, reason);
  const auto early = at(0.5);
  out.add(early ? medial(early->point, side) / kMillimetre : kNone, reason);
  out.add(std::atan(b) / kDegree, reason);
}

// Separations at equal steps of travel (mm); NaN where the condyle does not reach it on the way out
// and back.
CondylarSeparations::Side separations_mm(const JawPath& path, std::size_t side,
                                         const Outward& outward) {
  CondylarSeparations::Side separations;
  const auto inward = [](const Vector3d& point) { return -sagittal_size(point); };
  const auto inclination = [](const Vector3d& point) { return std::atan2(-point.z(), point.x()); };
  for (std::size_t i = 0; i < CondylarSeparations::kPlaces; ++i) {
    const double share = kLeastTravelShare + (kMostTravelShare - kLeastTravelShare) *
                                                 static_cast<double>(i) /
                                                 (CondylarSeparations::kPlaces - 1);
    const double travel_m = share * outward.top.value;
    const auto out = first_passage(path.time_s, path.condyle_m[side], path.condyle_m_s[side],
                                   outward.begin, outward.top.at, travel_m, sagittal_size);
    const auto back = first_passage(path.time_s, path.condyle_m[side], path.condyle_m_s[side],
                                    outward.top.at, path.time_s.size() - 1, -travel_m, inward);
    separations[i] = kNone;
    if (!out || !back) continue;
    const double angle = inclination(back->point) - inclination(out->point);
    separations[i] = travel_m * std::remainder(angle, 2 * std::numbers::pi) / kMillimetre;
  }
  return separations;
}

// Rotation over travel between two shares of the greatest travel (deg/mm).
double rotation_per_travel(const JawPath& path, std::size_t side, const Outward& outward) {
  double angle_rad[2];
  for (int i = 0; i < 2; ++i) {
    const double travel_m = (i == 0 ? kSlopeFrom : kSlopeTo) * outward.top.value;
    const auto at = first_passage(path.time_s, path.condyle_m[side], path.condyle_m_s[side],
                                  outward.begin, outward.top.at, travel_m, sagittal_size);
    if (!at || outward.top.value < kLeastSlopeTravel_m) return kNone;
    angle_rad[i] = (1 - at->share) * twist_about(path.rotation_rad[at->after], 1) +
                   at->share * twist_about(path.rotation_rad[at->after + 1], 1);
  }
  return (angle_rad[1] - angle_rad[0]) / kDegree /
         ((kSlopeTo - kSlopeFrom) * outward.top.value / kMillimetre);
}

void add_condylar_motion(TaskKind kind, const JawPath& path, std::size_t side,
                         const Outward& outward, const CondylarSeparations::Side& separations,
                         ReadingValues& out) {
  const std::vector<double> speeds = sizes_of(path.condyle_m_s[side]);
  out.add(greatest_of(path.time_s, speeds, 0, outward.top.at + 1, top_reach_s(path)).value /
          kMillimetre);
  double sum_mm = 0;
  for (const double mm : separations) sum_mm += std::abs(mm);
  out.add(sum_mm / static_cast<double>(separations.size()),
          [] { return std::string("the condyle does not come back over its whole path"); });
  out.add(0);  // crossings, which are counted later
  if (kind != TaskKind::opening) return;
  out.add(rotation_per_travel(path, side, outward), [&] {
    return fmt::format("the condyle travels {:.1f} mm, at least {:g} mm are needed",
                       outward.top.value / kMillimetre, kLeastSlopeTravel_m / kMillimetre);
  });
}

}  // namespace

double medial(const Vector3d& point, std::size_t side) {
  return side == 0 ? -point.y() : point.y();
}

void add_condyle_names(TaskKind kind, std::vector<StrokeReading>& names) {
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t index = side == Side::left ? 0 : 1;
    names.push_back({"condylar_path_mm", side});
    names.push_back({"condylar_translation_mm", side});
    if (!goes_forward(kind, index)) continue;
    for (const auto& [inclination, bennett] :
         {std::pair("condylar_inclination_3mm_deg", "bennett_angle_3mm_deg"),
          std::pair("condylar_inclination_5mm_deg", "bennett_angle_5mm_deg"),
          std::pair("condylar_inclination_10mm_deg", "bennett_angle_10mm_deg")}) {
      names.push_back({inclination, side});
      if (orbits(kind, index)) names.push_back({bennett, side});
    }
    if (orbits(kind, index)) {
      names.push_back({"side_shift_mm", side});
      names.push_back({"side_shift_05mm_mm", side});
      names.push_back({"progressive_side_shift_deg", side});
    }
    names.push_back({"condylar_peak_speed_mm_s", side});
    names.push_back({"condylar_separation_mm", side});
    names.push_back({"condylar_crossing_count", side});
    if (kind == TaskKind::opening) names.push_back({"rotation_per_translation_deg_mm", side});
  }
  names.push_back({"condylar_path_difference_mm", Side::none});
  names.push_back({"condylar_translation_difference_mm", Side::none});
}

CondylarSeparations add_condyles(TaskKind kind, const JawPath& path, ReadingValues& out) {
  CondylarSeparations separations{};
  PathReading lengths[2];
  double translation_mm[2], shortfalls_mm = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    const Outward outward = outward_of(path, side);
    lengths[side] = add_path(path, side, outward, out);
    const Greatest translation = top_of(path, sizes_of(path.condyle_m[side]));
    translation_mm[side] = translation.value / kMillimetre;
    shortfalls_mm += shortfall_of(translation) / kMillimetre;
    out.add_top(translation, kMillimetre);
    if (!goes_forward(kind, side)) continue;
    add_inclinations(path, side, outward, orbits(kind, side), out);
    if (orbits(kind, side)) add_side_shift(path, side, outward, out);
    separations.mm[side] = separations_mm(path, side, outward);
    add_condylar_motion(kind, path, side, outward, separations.mm[side], out);
  }
  out.add(lengths[0].length_mm - lengths[1].length_mm);
  out.keep_shortfall(lengths[0].difference_mm + lengths[1].difference_mm);
  out.add(translation_mm[0] - translation_mm[1]);
  out.keep_shortfall(shortfalls_mm);
  return separations;
}

void add_separations(TaskKind kind, const JawPath& path, const CondylarSeparations& separations,
                     ReadingValues& out) {
  for (std::size_t side = 0; side < 2; ++side) {
    if (!goes_forward(kind, side)) continue;
    for (const double separation_mm : separations.mm[side]) {
      out.add(separation_mm,
              [] { return std::string("the condyle does not come back over its whole path"); });
    }
    // Means over a share of the stroke at both ends.
    const Points& points = path.condyle_m[side];
    const std::size_t count = std::max<std::size_t>(points.size() / kEnds, 1);
    Vector3d closure = Vector3d::Zero();
    for (std::size_t k = 0; k < count; ++k) closure += points[points.size() - 1 - k] - points[k];
    out.add(sagittal_size(closure) / static_cast<double>(count) / kMillimetre);
  }
}

void finish_separations(const std::vector<StrokeReading>& names,
                        std::vector<UncertainValue>& values) {
  std::size_t next = names.size();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].name != "condylar_crossing_count") continue;
    UncertainValue count;
    count.value = 0;
    int last = 0;
    for (std::size_t k = 0; k < CondylarSeparations::kPlaces && next < values.size(); ++k, ++next) {
      const UncertainValue& separation = values[next];
      if (!std::isfinite(separation.value)) {
        count.value = kNone;
        count.missing = separation.missing;
      }
      // Beyond its interval, about 2 sd, and large enough to mean anything.
      const double least_mm = std::max(separation.half_interval(), kLeastSeparation_mm);
      if (!(std::abs(separation.value) > least_mm)) continue;
      const int sign = separation.value > 0 ? 1 : -1;
      if (last != 0 && sign != last) count.value += 1;
      last = sign;
    }
    values[i] = count;
    // What a slip of the instrument leaves at the end, it may leave on the whole way back.
    UncertainValue& mean = values[i - 1];
    const double closure_mm = next < values.size() ? values[next++].value : kNone;
    mean.doubt = std::hypot(mean.doubt, closure_mm);
  }
  values.resize(names.size());
}

void withhold_condyles(const std::vector<StrokeReading>& names, const std::string& why,
                       std::vector<UncertainValue>& values) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!is_condylar(names[i].name)) continue;
    values[i].value = JawReading::kNone;
    values[i].is_hidden = false;
    values[i].missing = why;
  }
}

}  // namespace condyle::host
