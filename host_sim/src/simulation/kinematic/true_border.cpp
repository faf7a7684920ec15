// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/true_border.h"

#include <Eigen/Geometry>
#include <array>
#include <set>
#include <utility>

namespace condyle::host {
namespace {

using Eigen::Vector3d;
using namespace truth;

constexpr double kNear_mm = 1;     // the reference position: ends of an excursion
constexpr double kApart_mm = 0.1;  // points of the hull
constexpr double kSame_mm = 1e-4;  // corners that are visited again
constexpr const char* kPlanes[] = {"frontal", "sagittal", "horizontal"};  // across X, Y, Z

// Greatest area of an excursion beyond kNear_mm, from the very passage of that distance, in the
// three planes.
Vector3d greatest_loops_mm2(const PathFunction& place_mm, const Span& span) {
  Vector3d swept = Vector3d::Zero(), most = Vector3d::Zero();
  const auto distance_mm = [&](double t) { return place_mm(t).norm(); };
  double last_s = span.begin_s;
  at_instants(span, [&](double time_s) {
    Vector3d from_mm = place_mm(last_s), to_mm = place_mm(time_s);
    const bool was_near = from_mm.norm() < kNear_mm, is_near = to_mm.norm() < kNear_mm;
    if (was_near && !is_near) {
      from_mm = place_mm(*first_passage_s(distance_mm, {last_s, time_s}, kNear_mm));
    }
    if (is_near && !was_near) {
      const auto nearness_mm = [&](double t) { return -distance_mm(t); };
      to_mm = place_mm(*first_passage_s(nearness_mm, {last_s, time_s}, -kNear_mm));
    }
    if (!was_near || !is_near) swept += from_mm.cross(to_mm) / 2;
    if (is_near || time_s >= span.end_s) {
      most = most.cwiseMax(swept.cwiseAbs());
      swept.setZero();
    }
    last_s = time_s;
  });
  return most;
}

// The convex hull by gift wrapping: from the edge of a face, the plane turns until it meets a
// point.
class WrappedHull {
 public:
  explicit WrappedHull(const std::vector<Vector3d>& points) : points_(points) {
    std::size_t a = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].z() < points[a].z()) a = i;
    }
    // The plane Z = z of the lowest point touches the hull; it turns about a line in it.
    const Vector3d aside = points[a] + Vector3d::UnitX();
    const std::size_t b = next(points[a], aside, a, a);
    wrap(a, b, next(points[a], points[b], a, b));
  }
  double volume_mm3() const { return volume_; }
  // Of the projection along each axis: half of what its faces project.
  Vector3d areas_mm2() const { return projected_ / 2; }

 private:
  // The point for which all others lie to the left of the plane through p, q and it.
  std::size_t next(const Vector3d& p, const Vector3d& q, std::size_t first,
                   std::size_t second) const {
    std::size_t best = points_.size();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (i == first || i == second) continue;
      if (best == points_.size() || (q - p).cross(points_[best] - p).dot(points_[i] - p) > 0) {
        best = i;
      }
    }
    return best;
  }

  void wrap(std::size_t a, std::size_t b, std::size_t c) {
    std::set<std::pair<std::size_t, std::size_t>> done;
    std::vector<std::array<std::size_t, 2>> open;
    const auto add = [&](std::size_t i, std::size_t j, std::size_t k) {
      const Vector3d normal = (points_[j] - points_[i]).cross(points_[k] - points_[i]) / 2;
      volume_ += normal.dot(points_[i]) / 3;
      projected_ += normal.cwiseAbs();
      for (const auto& [from, to] : {std::pair(i, j), std::pair(j, k), std::pair(k, i)}) {
        done.emplace(from, to);
        open.push_back({to, from});  // as the face beside has it
      }
    };
    add(a, b, c);
    while (!open.empty()) {
      const auto [from, to] = open.back();
      open.pop_back();
      if (done.count({from, to}) > 0) continue;
      add(from, to, next(points_[from], points_[to], from, to));
    }
  }

  const std::vector<Vector3d>& points_;
  double volume_ = 0;
  Vector3d projected_ = Vector3d::Zero();
};

// Points of the path that are apart, the corners, where it is slowest, among them.
std::vector<Vector3d> hull_points(const PathFunction& place_mm, const Span& span) {
  std::vector<Vector3d> all, points;
  at_instants(span, [&](double time_s) { all.push_back(place_mm(time_s)); });
  const auto add = [&](const Vector3d& point, double apart_mm) {
    const bool is_apart = std::none_of(points.begin(), points.end(), [&](const Vector3d& other) {
      return (point - other).squaredNorm() < apart_mm * apart_mm;
    });
    if (is_apart) points.push_back(point);
  };
  for (std::size_t i = 2; i + 2 < all.size(); ++i) {
    const auto step = [&](std::size_t k) { return (all[k + 1] - all[k - 1]).norm(); };
    if (step(i) <= step(i - 1) && step(i) <= step(i + 1)) add(all[i], kSame_mm);
  }
  for (const Vector3d& point : all) add(point, kApart_mm);
  return points;
}

}  // namespace

std::vector<TrueBorderValue> true_border(const PathFunction& place_mm, const Span& span) {
  std::vector<TrueBorderValue> values;
  const std::vector<Vector3d> points = hull_points(place_mm, span);
  const WrappedHull hull(points);
  const Vector3d loops_mm2 = greatest_loops_mm2(place_mm, span);
  for (int i = 0; i < 3; ++i) {
    const std::string plane = kPlanes[i];
    values.push_back({"border_loop_" + plane + "_mm2", loops_mm2[i], "mm2"});
    values.push_back({"border_area_" + plane + "_mm2", hull.areas_mm2()[i], "mm2"});
  }
  values.push_back({"border_volume_mm3", hull.volume_mm3(), "mm3"});
  return values;
}

}  // namespace condyle::host
