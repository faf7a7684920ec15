// SPDX-License-Identifier: Apache-2.0
#include "readings/path_measures.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "condyle/estimator/pose/rotation_vector.h"

namespace condyle::host {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {
constexpr double kLeastTurn = 1e-6;  // determinant over trace^2 of poses that turn about an axis
}  // namespace

std::size_t greatest_at(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto last = values.begin() + static_cast<std::ptrdiff_t>(end);
  return begin + static_cast<std::size_t>(std::max_element(first, last) - first);
}

namespace {

// The greatest of `values` (see Greatest). `mean(k)`: their mean around k; `reaches(k, i)`: that
// mean contains the values k - i and k + i.
template <class Mean, class Reaches>
Greatest greatest_by(const std::vector<double>& time_s, const std::vector<double>& values,
                     std::size_t begin, std::size_t end, const Mean& mean, const Reaches& reaches) {
  const auto [lowest, highest] =
      std::minmax_element(values.begin() + static_cast<std::ptrdiff_t>(begin),
                          values.begin() + static_cast<std::ptrdiff_t>(end));
  // A mean near the highest value, from which the means fall on both sides.
  auto at = static_cast<std::size_t>(highest - values.begin());
  double best = mean(at);
  for (const bool is_forward : {false, true}) {
    while (is_forward ? at + 1 < end : at > begin) {
      const std::size_t next = is_forward ? at + 1 : at - 1;
      const double there = mean(next);
      if (!(there > best)) break;
      best = there;
      at = next;
    }
  }
  // A mean is as great only if it contains a value as great, up to rounding.
  const double least = best - 1e-12 * (std::abs(*lowest) + std::abs(*highest));
  // The samples whose mean can contain the first or the last of these values, or one between them.
  std::size_t first = begin, last = end - 1;
  while (values[first] < least) ++first;
  while (values[last] < least) --last;
  const auto contains = [&](std::size_t k, std::size_t i) {
    return i <= std::min(k - begin, end - 1 - k) && reaches(k, i);
  };
  std::size_t low = first, high = last;
  while (low > begin && contains(low - 1, first - (low - 1))) --low;
  while (high + 1 < end && contains(high + 1, high + 1 - last)) ++high;
  // To the next such value, in either direction.
  std::vector<std::size_t> distances(high + 1 - low);
  std::size_t distance = 0;
  for (std::size_t k = high + 1; k-- > low;) {
    distance = values[k] >= least ? 0 : k > last ? end - begin : distance + 1;
    distances[k - low] = distance;
  }
  at = begin;
  best = -std::numeric_limits<double>::infinity();
  for (std::size_t k = low; k <= high; ++k) {
    distance = values[k] >= least ? 0 : k < first ? end - begin : distance + 1;
    if (!contains(k, std::min(distance, distances[k - low]))) continue;
    const double there = mean(k);
    if (!(there > best)) continue;
    best = there;
    at = k;
  }
  Greatest greatest{at, time_s[at], values[at], *highest};
  if (at == begin || at + 1 >= end) return greatest;
  // A parabola through three samples, values[at] + slope x + curve x^2; another through the means.
  const double a = time_s[at - 1] - time_s[at], b = time_s[at + 1] - time_s[at];
  const auto parabola = [&](double before, double here, double after) {
    const double p = before - here, q = after - here;
    const double curve = (p * b - q * a) / (a * b * (a - b));
    return std::pair((p - curve * a * a) / a, curve);
  };
  const auto [mean_slope, mean_curve] = parabola(mean(at - 1), mean(at), mean(at + 1));
  if (!(mean_curve < 0)) return greatest;
  const double x = std::clamp(-mean_slope / (2 * mean_curve), a / 2, b / 2);
  const auto [slope, curve] = parabola(values[at - 1], values[at], values[at + 1]);
  greatest.time_s += x;
  greatest.value += (slope + curve * x) * x;
  return greatest;
}

// Triangular weight of the samples k - i and k + i in the mean around k; `per_s` = 1/(2 reach).
double weight_of(const std::vector<double>& time_s, std::size_t k, std::size_t i, double per_s) {
  return 1 - (time_s[k + i] - time_s[k - i]) * per_s;
}

}  // namespace

double shortfall_of(const Greatest& top) {
  return std::max(top.highest - top.value, 0.0);
}

Greatest greatest_of(const std::vector<double>& time_s, const std::vector<double>& values,
                     std::size_t begin, std::size_t end, double reach_s) {
  const double per_s = 0.5 / reach_s;
  const auto mean = [&](std::size_t k) {
    double sum = values[k], weights = 1;
    for (std::size_t i = 1; k >= begin + i && k + i < end; ++i) {
      const double weight = weight_of(time_s, k, i, per_s);
      if (weight <= 0) break;
      sum += weight * (values[k - i] + values[k + i]);
      weights += 2 * weight;
    }
    return sum / weights;
  };
  return greatest_by(time_s, values, begin, end, mean, [&](std::size_t k, std::size_t i) {
    return weight_of(time_s, k, i, per_s) > 0;
  });
}

double roughness_of(const std::vector<double>& time_s, const std::vector<double>& values,
                    const Greatest& top, double reach_s) {
  constexpr Eigen::Index kPowers = 3;
  std::size_t begin = top.at, end = top.at + 1;
  while (begin > 0 && time_s[top.at] - time_s[begin - 1] <= reach_s) --begin;
  while (end < values.size() && time_s[end] - time_s[top.at] <= reach_s) ++end;
  const auto count = static_cast<Eigen::Index>(end - begin);
  if (count <= kPowers) return 0;
  Eigen::Matrix<double, Eigen::Dynamic, kPowers> powers(count, kPowers);
  Eigen::VectorXd seen(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t k = begin + static_cast<std::size_t>(i);
    const double x = (time_s[k] - time_s[top.at]) / reach_s;
    powers.row(i) << 1, x, x * x;
    seen[i] = values[k];
  }
  const Vector3d fit = (powers.transpose() * powers).ldlt().solve(powers.transpose() * seen);
  return std::sqrt((seen - powers * fit).squaredNorm() / static_cast<double>(count - kPowers));
}

GreatestAt::GreatestAt(const std::vector<double>& time_s, double reach_s) : time_s_(time_s) {
  const double per_s = 0.5 / reach_s;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    first_.push_back(weights_.size());
    double sum = 1;
    for (std::size_t i = 1; k >= i && k + i < time_s.size(); ++i) {
      const double weight = weight_of(time_s, k, i, per_s);
      if (weight <= 0) break;
      sum += 2 * weight;
      weights_.push_back({weight, sum});
    }
  }
  first_.push_back(weights_.size());
}

Greatest GreatestAt::of(const std::vector<double>& values, std::size_t begin,
                        std::size_t end) const {
  const auto mean = [&](std::size_t k) {
    const Weight* const weights = weights_.data() + first_[k];
    const std::size_t count = std::min({first_[k + 1] - first_[k], k - begin, end - 1 - k});
    const double* const middle = &values[k];
    double sum = *middle;
    for (std::size_t i = 1; i <= count; ++i) {
      sum += weights[i - 1].weight * (*(middle - i) + middle[i]);
    }
    return count == 0 ? sum : sum / weights[count - 1].sum;
  };
  return greatest_by(time_s_, values, begin, end, mean,
                     [&](std::size_t k, std::size_t i) { return i <= first_[k + 1] - first_[k]; });
}

void PathLength::begin(const Vector3d& point_m) {
  from_m_ = last_m_ = point_m;
  chords_m_ = 0;
}

void PathLength::add(const Vector3d& point_m) {
  // Chords of the given length along the segment, which may hold several.
  while ((point_m - from_m_).norm() >= chord_m_) {
    const Vector3d a = last_m_ - from_m_, along = point_m - last_m_;
    // |a + x along| = chord
    const double A = along.squaredNorm(), B = a.dot(along);
    const double C = a.squaredNorm() - chord_m_ * chord_m_;
    const double x = A > 0 ? (-B + std::sqrt(std::max(B * B - A * C, 0.0))) / A : 1;
    from_m_ = last_m_ + std::clamp(x, 0.0, 1.0) * along;
    chords_m_ += chord_m_;
  }
  last_m_ = point_m;
}

double hull_area(const Points& points, int first, int second) {
  using Point = std::pair<double, double>;
  std::vector<Point> sorted;
  for (const Vector3d& point : points) sorted.emplace_back(point[first], point[second]);
  std::sort(sorted.begin(), sorted.end());
  if (sorted.size() < 3) return 0;
  const auto turn = [](const Point& a, const Point& b, const Point& c) {
    return (b.first - a.first) * (c.second - a.second) -
           (b.second - a.second) * (c.first - a.first);
  };
  // Andrew's monotone chain.
  std::vector<Point> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = hull.size();
    for (const Point& point : sorted) {
      while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0) {
        hull.pop_back();
      }
      hull.push_back(point);
    }
    hull.pop_back();
    std::reverse(sorted.begin(), sorted.end());
  }
  double area = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Point& a = hull[i];
    const Point& b = hull[(i + 1) % hull.size()];
    area += a.first * b.second - b.first * a.second;
  }
  return std::abs(area) / 2;
}

double greatest_loop_m2(const Points& points, int first, int second, double near_m) {
  double greatest_m2 = 0, swept = 0;
  for (std::size_t k = 1; k < points.size(); ++k) {
    const Vector3d &a = points[k - 1], &b = points[k];
    // Triangles from the origin, so that the way in and out near it adds next to nothing.
    swept += (a[first] * b[second] - b[first] * a[second]) / 2;
    if (b.norm() >= near_m && k + 1 < points.size()) continue;
    greatest_m2 = std::max(greatest_m2, std::abs(swept));
    swept = 0;
  }
  return greatest_m2;
}

HelicalAxis helical_axis(const Vector3d& w_rad, const Vector3d& at_m, const Vector3d& d_m) {
  HelicalAxis axis;
  axis.angle_rad = w_rad.norm();
  axis.direction = w_rad / axis.angle_rad;
  axis.translation_m = axis.direction.dot(d_m);
  const Vector3d across = d_m - axis.translation_m * axis.direction;
  // The point of the axis nearest to the middle between the two places of the point.
  axis.point_m =
      at_m + 0.5 * (across + axis.direction.cross(across) / std::tan(axis.angle_rad / 2));
  return axis;
}

std::optional<Vector3d> hinge_axis_crossing_m(const JawPath& path,
                                              const std::vector<WeightedPose>& poses) {
  // About f, the point p moves to R p + m.
  std::vector<Matrix3d> rotations;
  Matrix3d mean = Matrix3d::Zero();
  Vector3d middle_m = Vector3d::Zero();
  double weight_s = 0;
  for (const WeightedPose& pose : poses) {
    rotations.push_back(rotation_of<double>(pose.rotation_rad));
    mean += pose.weight_s * rotations.back();
    middle_m += pose.weight_s * pose.middle_m;
    weight_s += pose.weight_s;
  }
  if (!(weight_s > 0)) return std::nullopt;
  const Vector3d f = path.middle_at_m;
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Matrix3d turn = rotations[k] - mean / weight_s;
    const Vector3d moved_m = poses[k].middle_m - middle_m / weight_s - turn.col(1) * f.y();
    Eigen::Matrix<double, 3, 2> columns;
    columns << turn.col(0), turn.col(2);
    normal += poses[k].weight_s * columns.transpose() * columns;
    right -= poses[k].weight_s * columns.transpose() * moved_m;
  }
  const double size = normal.trace();
  if (!(normal.determinant() > kLeastTurn * size * size)) return std::nullopt;
  const Eigen::Vector2d p = normal.inverse() * right;
  return Vector3d(f.x() + p.x(), 0, f.z() + p.y());
}

}  // namespace condyle::host
