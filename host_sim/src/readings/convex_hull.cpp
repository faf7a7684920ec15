// SPDX-License-Identifier: Apache-2.0
#include "readings/convex_hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr double kFlat = 1e-9;  // of the points' extent: what lies in a face

class Hull {
 public:
  explicit Hull(const std::vector<Vector3d>& points) : points_(points) {
    if (!begin()) return;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (!faces_[f].outside.empty()) raise(f);
    }
  }

  double volume() const {
    double volume = 0;
    for (const Face& face : faces_) {
      if (face.is_gone) continue;
      volume += (at(face.corner[0]) - middle_)
                    .dot((at(face.corner[1]) - middle_).cross(at(face.corner[2]) - middle_)) /
                6;
    }
    return volume;
  }

  std::vector<Vector3d> corners() const {
    if (faces_.empty()) return points_;
    std::vector<bool> is_corner(points_.size(), false);
    for (const Face& face : faces_) {
      for (const std::size_t i : face.corner) is_corner[i] = is_corner[i] || !face.is_gone;
    }
    std::vector<Vector3d> corners;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (is_corner[i]) corners.push_back(points_[i]);
    }
    return corners;
  }

 private:
  // A triangle, anticlockwise as seen from outside.
  struct Face {
    std::array<std::size_t, 3> corner;
    std::array<std::size_t, 3> beside{};  // the face across the edge from corner i to the next
    Vector3d normal;
    double offset = 0;
    std::vector<std::size_t> outside;  // points above it, the farthest first
    double farthest = 0;
    bool is_gone = false;
  };
  struct Edge {
    std::size_t face, edge;  // of the face that stays
  };

  const Vector3d& at(std::size_t i) const { return points_[i]; }

  Face face_of(std::size_t a, std::size_t b, std::size_t c) const {
    Face face{{a, b, c}};
    face.normal = (at(b) - at(a)).cross(at(c) - at(a)).normalized();
    face.offset = face.normal.dot(at(a));
    return face;
  }
  double height(const Face& face, std::size_t i) const {
    return face.normal.dot(at(i)) - face.offset;
  }
  // Gives the point to the face if it lies above it.
  bool takes(Face& face, std::size_t i) const {
    const double above = height(face, i);
    if (!(above > flat_)) return false;
    face.outside.push_back(i);
    if (above > face.farthest) {
      face.farthest = above;
      std::swap(face.outside.front(), face.outside.back());
    }
    return true;
  }

  template <class Size>
  std::size_t most(const Size& size) const {
    std::size_t best = 0;
    double greatest = size(0);
    for (std::size_t i = 1; i < points_.size(); ++i) {
      const double now = size(i);
      if (!(now > greatest)) continue;
      greatest = now;
      best = i;
    }
    return best;
  }

  // A tetrahedron of points that are far from each other. False: all lie in a plane.
  bool begin() {
    if (points_.size() < 4) return false;
    const std::size_t a = most([&](std::size_t i) { return -at(i).x(); });
    const std::size_t b = most([&](std::size_t i) { return (at(i) - at(a)).squaredNorm(); });
    const Vector3d along = (at(b) - at(a)).normalized();
    flat_ = kFlat * (at(b) - at(a)).norm();
    const std::size_t c =
        most([&](std::size_t i) { return along.cross(at(i) - at(a)).squaredNorm(); });
    const Face base = face_of(a, b, c);
    const std::size_t d = most([&](std::size_t i) { return std::abs(height(base, i)); });
    if (!(along.cross(at(c) - at(a)).norm() > flat_) || !(std::abs(height(base, d)) > flat_)) {
      return false;
    }
    middle_ = (at(a) + at(b) + at(c) + at(d)) / 4;
    const bool is_below = height(base, d) < 0;
    const std::size_t p = is_below ? a : b, q = is_below ? b : a;
    faces_ = {face_of(p, q, c), face_of(q, p, d), face_of(c, q, d), face_of(p, c, d)};
    faces_[0].beside = {1, 2, 3};
    faces_[1].beside = {0, 3, 2};
    faces_[2].beside = {0, 1, 3};
    faces_[3].beside = {0, 2, 1};
    for (std::size_t i = 0; i < points_.size(); ++i) {
      for (Face& face : faces_) {
        if (takes(face, i)) break;
      }
    }
    return true;
  }

  // Replaces the faces that the farthest point above face `first` sees by a cone to that point.
  void raise(std::size_t first) {
    const std::size_t apex = faces_[first].outside.front();
    std::vector<std::size_t> seen;
    std::vector<Edge> horizon;
    look(first, 3, apex, seen, horizon);
    const std::size_t cone = faces_.size();
    for (std::size_t i = 0; i < horizon.size(); ++i) {
      const Edge& edge = horizon[i];
      const auto& corner = faces_[edge.face].corner;
      Face face = face_of(corner[(edge.edge + 1) % 3], corner[edge.edge], apex);
      face.beside = {edge.face, cone + (i + 1) % horizon.size(),
                     cone + (i + horizon.size() - 1) % horizon.size()};
      faces_[edge.face].beside[edge.edge] = cone + i;
      faces_.push_back(std::move(face));
    }
    for (const std::size_t f : seen) {
      const std::vector<std::size_t> outside = std::move(faces_[f].outside);
      for (const std::size_t i : outside) {
        for (std::size_t k = cone; k < faces_.size() && i != apex; ++k) {
          if (takes(faces_[k], i)) break;
        }
      }
      faces_[f].outside.clear();
    }
  }

  // The faces that point `apex` sees, from face `f`, entered across its edge `entry` (3: none), and
  // the edges around them, in the order of the corners.
  void look(std::size_t f, std::size_t entry, std::size_t apex, std::vector<std::size_t>& seen,
            std::vector<Edge>& horizon) {
    faces_[f].is_gone = true;
    seen.push_back(f);
    const std::size_t steps = entry == 3 ? 3 : 2;
    for (std::size_t i = 0; i < steps; ++i) {
      const std::size_t edge = entry == 3 ? i : (entry + 1 + i) % 3;
      const std::size_t other = faces_[f].beside[edge];
      if (faces_[other].is_gone) continue;
      std::size_t back = 0;
      while (back < 3 && faces_[other].beside[back] != f) ++back;
      if (back == 3) continue;  // rounding has torn the surface here
      if (height(faces_[other], apex) > flat_) {
        look(other, back, apex, seen, horizon);
      } else {
        horizon.push_back({other, back});
      }
    }
  }

  const std::vector<Vector3d>& points_;
  std::vector<Face> faces_;
  Vector3d middle_ = Vector3d::Zero();
  double flat_ = 0;
};

}  // namespace

ConvexHull convex_hull(const std::vector<Vector3d>& points) {
  const Hull hull(points);
  return {hull.volume(), hull.corners()};
}

}  // namespace condyle::host
