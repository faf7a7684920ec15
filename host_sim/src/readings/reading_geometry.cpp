// SPDX-License-Identifier: Apache-2.0
#include "readings/reading_geometry.h"

#include <cmath>

#include "condyle/estimator/pose/rotation_vector.h"

namespace condyle::host {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Of a rotation vector w: sin x/x, (1 - cos x)/x^2 and (x - sin x)/x^3 at its length x.
struct Turn {
  double sine, cosine, cubic;
};
// Taylor series of so many terms.
template <std::size_t terms>
Turn series_of(double square) {
  constexpr auto kSine = elementary::detail::reciprocal_factorials<double, terms>(1, 2);
  constexpr auto kCosine = elementary::detail::reciprocal_factorials<double, terms>(2, 2);
  constexpr auto kCubic = elementary::detail::reciprocal_factorials<double, terms>(3, 2);
  Turn turn{0, 0, 0};
  for (std::size_t i = terms; i-- > 0;) {
    turn.sine = kSine[i] - square * turn.sine;
    turn.cosine = kCosine[i] - square * turn.cosine;
    turn.cubic = kCubic[i] - square * turn.cubic;
  }
  return turn;
}
// All terms above 1e-17. A jaw turns by less than 1 rad, in chewing by less than 0.24 rad.
Turn turn_of(const Vector3d& w) {
  const double square = w.squaredNorm();
  if (square < 0.06) return series_of<6>(square);
  if (square < 1) return series_of<10>(square);
  const double angle = std::sqrt(square);
  return {internal::sinc(angle), internal::cosine_share(angle), internal::sine_share(angle)};
}

}  // namespace

ReadingGeometry geometry_of(const Landmarks& landmarks, const Vector3d& middle_m) {
  ReadingGeometry geometry;
  geometry.has_landmarks = true;
  geometry.head = head_frame(landmarks);
  geometry.middle_m = middle_m;
  geometry.incisor_m = landmarks.point_m[Landmarks::incisor_lower];
  geometry.condyle_m = {landmarks.point_m[Landmarks::condyle_left],
                        landmarks.point_m[Landmarks::condyle_right]};
  return geometry;
}

void turning_of(const SmoothMotion& motion, TurningMotion& turning) {
  const std::size_t count = motion.value.size();
  turning.rotation.resize(count);
  turning.angular_velocity_rad_s.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Vector3d w = motion.value[k].tail<3>();
    const Vector3d rate = motion.slope[k].tail<3>(), across = w.cross(rate);
    const Turn turn = turn_of(w);
    turning.rotation[k] = internal::with_powers(w, turn.sine, turn.cosine);
    turning.angular_velocity_rad_s[k] = rate + turn.cosine * across + turn.cubic * w.cross(across);
  }
}

void paths_of(const SmoothMotion& motion, const TurningMotion& turning,
              const ReadingGeometry& geometry, PathPart part, JawPath& path) {
  const Matrix3d into_head = geometry.head.linear().transpose();
  const std::size_t count = motion.time_s.size();
  path.time_s = motion.time_s;
  path.incisor_m.resize(count);
  path.incisor_m_s.resize(count);
  const bool has_all = part == PathPart::all;
  if (has_all) {
    for (auto* points :
         {&path.condyle_m[0], &path.condyle_m[1], &path.condyle_m_s[0], &path.condyle_m_s[1],
          &path.rotation_rad, &path.turning_rad_s, &path.middle_m}) {
      points->resize(count);
    }
  }
  const Vector3d f = geometry.middle_m;
  // The reference was mistaken by a small motion: undone from the right.
  const Matrix3d undo = rotation_of<double>(-geometry.reference_turn_rad);
  const bool is_mistaken = !geometry.reference_turn_rad.isZero(0);
  for (int side = 0; side < 2; ++side) {
    path.condyle_at_m[static_cast<std::size_t>(side)] =
        geometry.head.inverse(Eigen::Isometry) * geometry.condyle_m[static_cast<std::size_t>(side)];
  }
  path.incisor_at_m = geometry.head.inverse(Eigen::Isometry) * geometry.incisor_m;
  path.middle_at_m = geometry.head.inverse(Eigen::Isometry) * f;
  for (std::size_t k = 0; k < count; ++k) {
    const Vector3d w = motion.value[k].tail<3>();
    Matrix3d R = turning.rotation[k];
    const Vector3d& omega = turning.angular_velocity_rad_s[k];
    Vector3d u = motion.value[k].head<3>() - R * geometry.reference_shift_m;
    if (is_mistaken) R = R * undo;
    const auto place = [&](const Vector3d& b, Vector3d& d, Vector3d& v) {
      const Vector3d turned = R * (b - f);
      d = into_head * (u + turned - (b - f));
      v = into_head * (motion.slope[k].head<3>() + omega.cross(turned));
    };
    place(geometry.incisor_m, path.incisor_m[k], path.incisor_m_s[k]);
    if (!has_all) continue;
    for (std::size_t side = 0; side < 2; ++side) {
      place(geometry.condyle_m[side], path.condyle_m[side][k], path.condyle_m_s[side][k]);
    }
    path.rotation_rad[k] = into_head * (is_mistaken ? rotation_vector_of<double>(R) : w);
    path.turning_rad_s[k] = into_head * omega;
    path.middle_m[k] = into_head * u;
  }
}

void paths_of(const SmoothMotion& motion, const ReadingGeometry& geometry, JawPath& path) {
  TurningMotion turning;
  turning_of(motion, turning);
  paths_of(motion, turning, geometry, PathPart::all, path);
}

double twist_about(const Vector3d& vector_rad, int axis) {
  const double angle = vector_rad.norm();
  if (angle == 0) return 0;
  return 2 * std::atan2(std::sin(angle / 2) * vector_rad[axis] / angle, std::cos(angle / 2));
}

}  // namespace condyle::host
