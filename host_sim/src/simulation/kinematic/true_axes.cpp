// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/true_axes.h"

#include <Eigen/LU>
#include <cmath>

namespace condyle::host {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using namespace truth;

// The point of Y = 0 that a motion with the angular velocity (or axis of turning) `omega` and the
// velocity (or displacement) field field(p) = field(0) + A p moves along `omega` alone.
Vector3d standing_point(const Vector3d& omega, const Vector3d& at_origin, const Matrix3d& A) {
  // Cross product of omega and the field is 0: its x and z components, linear in x and z.
  Matrix3d cross;
  cross << 0, -omega.z(), omega.y(), omega.z(), 0, -omega.x(), -omega.y(), omega.x(), 0;
  const Matrix3d C = cross * A;
  const Vector3d c = cross * at_origin;
  Eigen::Matrix2d left;
  left << C(0, 0), C(0, 2), C(2, 0), C(2, 2);
  const Eigen::Vector2d solution = left.inverse() * -Eigen::Vector2d(c.x(), c.z());
  return {solution.x(), 0, solution.y()};
}

Vector3d axis_of(const Matrix3d& R) {
  return {R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)};
}

// From pose a to pose b, p -> R p + t.
Vector3d finite_crossing_mm(const JawPose& a, const JawPose& b) {
  const Matrix3d R = b.rotation * a.rotation.transpose();
  const Vector3d t = b.translation_m - R * a.translation_m;
  return 1e3 * standing_point(axis_of(R), t, R - Matrix3d::Identity());
}

// The point (x, 0, z) that the poses from `turning` keep nearest to one place: least squares over
// time, by the trapezoidal rule.
Vector3d hinge_mm(const KinematicJaw& jaw, const Span& turning) {
  struct Sum {
    Matrix3d rotation = Matrix3d::Zero();
    Vector3d translation_m = Vector3d::Zero();
    double weight = 0;
  } sum;
  const auto each = [&](const auto& use) {
    at_instants(turning, [&](double t) {
      const bool is_end = t == turning.begin_s || t >= turning.end_s;
      use(jaw.pose_at(t), is_end ? 0.5 : 1);
    });
  };
  each([&sum](const JawPose& pose, double weight) {
    sum.rotation += weight * pose.rotation;
    sum.translation_m += weight * pose.translation_m;
    sum.weight += weight;
  });
  Eigen::Matrix2d left = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  each([&](const JawPose& pose, double weight) {
    const Matrix3d moves = pose.rotation - sum.rotation / sum.weight;
    Eigen::Matrix<double, 3, 2> columns;
    columns << moves.col(0), moves.col(2);
    left += weight * columns.transpose() * columns;
    right -= weight * columns.transpose() * (pose.translation_m - sum.translation_m / sum.weight);
  });
  const Eigen::Vector2d point_m = left.inverse() * right;
  return {1e3 * point_m.x(), 0, 1e3 * point_m.y()};
}

struct Mean {
  std::vector<Vector3d> points;
  std::vector<double> weights;
  void give(const std::string& name, std::vector<TrueAxisValue>& into) const {
    Vector3d mean = Vector3d::Zero();
    double total = 0, squares = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      mean += weights[i] * points[i];
      total += weights[i];
    }
    mean /= total;
    for (std::size_t i = 0; i < points.size(); ++i) {
      squares += weights[i] * (points[i] - mean).squaredNorm() / total;
    }
    into.push_back({name + "_x_mm", mean.x()});
    into.push_back({name + "_z_mm", mean.z()});
    into.push_back({name + "_spread_mm", std::sqrt(squares)});
  }
};

}  // namespace

std::vector<TrueAxisValue> true_axes(const KinematicJaw& jaw, const Span& out) {
  std::vector<TrueAxisValue> values;
  const auto angle_deg = [&](double t) { return opening_angle_deg(jaw.pose_at(t).rotation); };
  const double widest_s = greatest_at_s(angle_deg, out), widest_deg = angle_deg(widest_s);
  if (widest_deg >= 5) {
    const Vector3d whole_mm = finite_crossing_mm(JawPose{}, jaw.pose_at(widest_s));
    values.push_back({"helical_axis_x_mm", whole_mm.x()});
    values.push_back({"helical_axis_z_mm", whole_mm.z()});
    const auto from_s = first_passage_s(angle_deg, out, 1);
    const auto to_s = first_passage_s(angle_deg, out, 12);
    if (from_s) {
      const Vector3d place_mm = hinge_mm(jaw, {*from_s, to_s ? *to_s : widest_s});
      values.push_back({"hinge_axis_x_mm", place_mm.x()});
      values.push_back({"hinge_axis_z_mm", place_mm.z()});
    }
  }
  if (widest_deg >= 20) {
    Mean finite;
    JawPose from;
    for (int quarter = 1; quarter <= 4; ++quarter) {
      const auto at_s = first_passage_s(angle_deg, out, widest_deg * quarter / 4);
      const JawPose to = jaw.pose_at(quarter < 4 && at_s ? *at_s : widest_s);
      finite.points.push_back(finite_crossing_mm(from, to));
      finite.weights.push_back(1);
      from = to;
    }
    finite.give("finite_axes", values);
  }
  Mean instantaneous;
  const auto slope = [](const auto& value, double t) {
    constexpr double h_s = 2e-4;  // fourth order
    return ((8 * (value(t + h_s) - value(t - h_s)) - (value(t + 2 * h_s) - value(t - 2 * h_s))) /
            (12 * h_s))
        .eval();
  };
  const auto spin = [&](double t) {
    return Matrix3d(slope([&](double at) { return jaw.pose_at(at).rotation; }, t) *
                    jaw.pose_at(t).rotation.transpose());
  };
  const auto rate = [&](double t) { return (axis_of(spin(t)) / 2).norm(); };
  const double fastest_s = greatest_at_s(rate, out), fast = rate(fastest_s) / 2;
  // Integrals over the time in which the jaw turns fast, by the trapezoidal rule.
  const Span turning{fall_s(rate, fastest_s, out.begin_s, fast),
                     fall_s(rate, fastest_s, out.end_s, fast)};
  at_instants(turning, [&](double t) {
    const Matrix3d W = spin(t);
    const Vector3d drift = slope([&](double at) { return jaw.pose_at(at).translation_m; }, t);
    instantaneous.points.push_back(
        1e3 * standing_point(axis_of(W) / 2, drift - W * jaw.pose_at(t).translation_m, W));
    const bool is_end = t == turning.begin_s || t >= turning.end_s;
    instantaneous.weights.push_back((is_end ? 0.5 : 1) * rate(t));
  });
  instantaneous.give("instantaneous_axis", values);
  return values;
}

}  // namespace condyle::host
