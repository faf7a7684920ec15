// SPDX-License-Identifier: Apache-2.0
#include "readings/point_body.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "condyle/estimator/pose/rigid_body.h"
#include "condyle/estimator/pose/rotation_vector.h"
#include "hosted/files/input_error.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kMostCandidates = 50, kMostLearned = 4000;
constexpr int kRounds = 3;
// Second singular value of an isosceles triangle of the smallest usable height.
constexpr double kSmallestSpread_m = 0.8 * kSmallestHeight_m;

std::vector<Index> points_in(const PointColumns& points_m) {
  std::vector<Index> there;
  for (Index i = 0; i < points_m.cols(); ++i) {
    if (points_m.col(i).allFinite()) there.push_back(i);
  }
  return there;
}

// The columns of `points_m` that are there in both.
std::vector<Index> points_in_both(const PointColumns& a, const PointColumns& b) {
  std::vector<Index> there;
  for (const Index i : points_in(a)) {
    if (b.col(i).allFinite()) there.push_back(i);
  }
  return there;
}

// How far the points are off a line.
double spread_m(const PointColumns& points_m, const std::vector<Index>& there) {
  if (there.size() < 3) return 0;
  PointColumns part = points_m(Eigen::all, there);
  part.colwise() -= Vector3d(part.rowwise().mean());
  return Eigen::JacobiSVD<Matrix3d>(part * part.transpose()).singularValues().cwiseSqrt()[1];
}

Isometry3d closest_motion(const PointColumns& from_m, const PointColumns& to_m,
                          const std::vector<Index>& there) {
  PointColumns a = from_m(Eigen::all, there), b = to_m(Eigen::all, there);
  const Vector3d middle_a = a.rowwise().mean(), middle_b = b.rowwise().mean();
  a.colwise() -= middle_a;
  b.colwise() -= middle_b;
  const Eigen::JacobiSVD<Matrix3d> svd(b * a.transpose(),
                                       Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
  Isometry3d pose;
  pose.linear() = U * svd.matrixV().transpose();
  pose.translation() = middle_b - pose.linear() * middle_a;
  return pose;
}

// Every n-th of `samples`, so that at most `most` are taken.
std::vector<const PointColumns*> some_of(const std::vector<PointColumns>& samples,
                                         std::size_t most) {
  std::vector<const PointColumns*> some;
  for (std::size_t i = 0; i < samples.size(); i += 1 + samples.size() / most) {
    some.push_back(&samples[i]);
  }
  return some;
}

// Of the samples with the most points the one whose distances are nearest to their medians.
PointColumns typical_sample(const std::vector<PointColumns>& samples) {
  std::size_t most = 0;
  for (const PointColumns& sample : samples) most = std::max(most, points_in(sample).size());
  std::vector<PointColumns> complete;
  for (const PointColumns& sample : samples) {
    if (points_in(sample).size() == most) complete.push_back(sample);
  }
  const auto learned = some_of(samples, kMostLearned),
             candidates = some_of(complete, kMostCandidates);
  std::vector<double> misfit_m(candidates.size(), 0);
  for (Index i = 0; i < samples[0].cols(); ++i) {
    for (Index j = 0; j < i; ++j) {
      std::vector<double> distances_m;
      for (const PointColumns* const sample : learned) {
        const double distance_m = (sample->col(i) - sample->col(j)).norm();
        if (std::isfinite(distance_m)) distances_m.push_back(distance_m);
      }
      if (distances_m.empty()) continue;
      const double usual_m = upper_median(distances_m);
      for (std::size_t k = 0; k < candidates.size(); ++k) {
        const double off_m = (candidates[k]->col(i) - candidates[k]->col(j)).norm() - usual_m;
        if (std::isfinite(off_m)) misfit_m[k] += std::abs(off_m);
      }
    }
  }
  return *candidates[static_cast<std::size_t>(std::min_element(misfit_m.begin(), misfit_m.end()) -
                                              misfit_m.begin())];
}

// The points in a frame of their own, so that medians of coordinates do not depend on the
// instrument's: X along the first two, and towards +Y the first that is clearly off that line.
PointColumns in_own_frame(const PointColumns& points_m) {
  const std::vector<Index> there = points_in(points_m);
  const Vector3d origin_m = points_m.col(there[0]);
  const Vector3d x = (points_m.col(there[1]) - origin_m).normalized();
  const auto off_line = [&](Index i) -> Vector3d {
    const Vector3d from_m = points_m.col(i) - origin_m;
    return from_m - from_m.dot(x) * x;
  };
  double farthest_m = 0;
  for (const Index i : there) farthest_m = std::max(farthest_m, off_line(i).norm());
  const auto third = std::find_if(there.begin(), there.end(),
                                  [&](Index i) { return off_line(i).norm() > farthest_m / 2; });
  Matrix3d axes;
  axes.col(0) = x;
  axes.col(1) = off_line(*third).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes.transpose() * (points_m.colwise() - origin_m);
}

// Each point's median place in the frame of the points `shape_m`.
PointColumns refined(const std::vector<const PointColumns*>& samples, const PointColumns& shape_m) {
  const auto count = static_cast<std::size_t>(shape_m.cols());
  std::vector<std::array<std::vector<double>, 3>> places(count);
  for (const PointColumns* const sample : samples) {
    const std::vector<Index> there = points_in_both(shape_m, *sample);
    if (spread_m(shape_m, there) < kSmallestSpread_m) continue;
    const Isometry3d back = closest_motion(*sample, shape_m, there);
    for (const Index i : points_in(*sample)) {
      const Vector3d place = back * sample->col(i);
      for (int axis = 0; axis < 3; ++axis) {
        places[static_cast<std::size_t>(i)][static_cast<std::size_t>(axis)].push_back(place[axis]);
      }
    }
  }
  PointColumns result = shape_m;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (places[i][axis].empty()) continue;
      result(static_cast<Index>(axis), static_cast<Index>(i)) =
          upper_median(std::move(places[i][axis]));
    }
  }
  return result;
}

// Information of the points about small motions of the body, for noise of 1 m.
Eigen::Matrix<double, 6, 6> information(const PointColumns& shape_m,
                                        const std::vector<Index>& there) {
  // Rotations times 0.05 m, so that all have a similar size.
  constexpr double kLength_m = 0.05;
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
  for (const Index i : there) {
    Eigen::Matrix<double, 3, 6> J;
    J << Matrix3d::Identity(), -cross_matrix<double>(shape_m.col(i)) / kLength_m;
    sum += J.transpose() * J;
  }
  return sum;
}

}  // namespace

PointBody::PointBody(const std::vector<PointColumns>& samples,
                     const std::vector<std::string>& names, const std::string& place) {
  PointColumns shape_m = typical_sample(samples);
  if (spread_m(shape_m, points_in(shape_m)) < kSmallestSpread_m) {
    throw InputError(place,
                     points_in(shape_m).size() < 3 ? "three of its points are never there together"
                                                   : "its points lie on a line or coincide",
                     "give three or more points of one rigid body that span a triangle, at least "
                     "5 mm off a line");
  }
  shape_m = in_own_frame(shape_m);
  const auto learned = some_of(samples, kMostLearned);
  for (int round = 0; round < kRounds; ++round) shape_m = refined(learned, shape_m);
  for (Index i = 0; i < shape_m.cols(); ++i) {
    if (shape_m.col(i).allFinite()) continue;
    throw InputError(place,
                     "its point " + names[static_cast<std::size_t>(i)] +
                         " is never there together with three others",
                     "leave it out");
  }
  *this = PointBody(shape_m);
}

PointBody::PointBody(const PointColumns& shape_m)
    : shape_m_(shape_m.colwise() - Vector3d(shape_m.rowwise().mean())) {}

BodyFit PointBody::fit(const PointColumns& points_m) const {
  BodyFit result;
  const std::vector<Index> there = points_in(points_m);
  // Half, so that noise does not make an accepted shape degenerate.
  if (spread_m(shape_m_, there) < kSmallestSpread_m ||
      spread_m(points_m, there) < kSmallestSpread_m / 2) {
    return result;
  }
  result.is_fitted = true;
  result.pose = closest_motion(shape_m_, points_m, there);
  double sum_m2 = 0;
  for (const Index i : there) {
    sum_m2 += (result.pose * shape_m_.col(i) - points_m.col(i)).squaredNorm();
  }
  result.residual_rms_m = std::sqrt(sum_m2 / static_cast<double>(there.size()));
  if (there.size() < static_cast<std::size_t>(shape_m_.cols())) {
    result.growth = growth_of(points_m);
  }
  return result;
}

double PointBody::growth_of(const PointColumns& points_m) const {
  const std::vector<Index> there = points_in(points_m);
  std::uint64_t key = 0;
  for (const Index i : there) key |= std::uint64_t{1} << static_cast<unsigned>(i);
  const auto [growth, is_new] = growths_.try_emplace(key, 1);
  if (is_new) {
    std::vector<Index> all(static_cast<std::size_t>(shape_m_.cols()));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
    using Matrix6d = Eigen::Matrix<double, 6, 6>;
    const Eigen::LLT<Matrix6d> root(information(shape_m_, all));
    Matrix6d share = root.matrixL().solve(information(shape_m_, there));
    share = root.matrixL().solve(share.transpose().eval());
    const double least =
        Eigen::SelfAdjointEigenSolver<Matrix6d>(share, Eigen::EigenvaluesOnly).eigenvalues()[0];
    growth->second = least > 0 ? std::max(1 / least, 1.0) : std::numeric_limits<double>::infinity();
  }
  return growth->second;
}

Isometry3d mean_pose(const std::vector<Isometry3d>& poses, std::size_t begin, std::size_t end) {
  Vector3d place_m = Vector3d::Zero(), turn_rad = Vector3d::Zero();
  const Matrix3d first = poses[begin].linear();
  for (std::size_t i = begin; i < end; ++i) {
    place_m += poses[i].translation();
    turn_rad += rotation_vector_of<double>(poses[i].linear() * first.transpose());
  }
  const double count = static_cast<double>(end - begin);
  Isometry3d mean;
  mean.linear() = rotation_of<double>(turn_rad / count) * first;
  mean.translation() = place_m / count;
  return mean;
}

}  // namespace condyle::host
