// SPDX-License-Identifier: Apache-2.0
// Learns the body to which three points belong, from the first samples that agree on it.
//
//   d_k        distance of the two points other than k, of one sample (m); the last 15 samples
//   m_k        median of the 15 distances
//   s          1.4826 median |d_k - m_k| / sqrt(2), over samples and k: the noise of a coordinate
//   if
//              the points were measured one by one, and about the residual of a fit
//   misfit     of a sample: |d - m| / sqrt(6), about the residual of its fit
//   tolerance  6 s; at least kSmallestTolerance_m, at most what the caller allows
//
// Once 12 of the last 15 samples have no more misfit than the tolerance, the body is that with the
// distances m. So three bad samples among them spoil nothing. Points whose s is above a third of
// what the caller allows make no body.
//
// Not noticed: an error that twelve samples share, of any size; a later change of the distances
// that stays within the tolerance. A point 90 mm from a bite fork is off by about 1.4 times the
// residual of such a change.
#pragma once

#include <algorithm>
#include <cmath>

#include "condyle/estimator/pose/rigid_body.h"

namespace condyle {

/// Smallest tolerance: the remaining error of digits and calibration in a device's rigidity.
inline constexpr double kSmallestTolerance_m = 1e-4;

/// See the model above. Fixed size.
template <class Scalar>
class BodyShape {
 public:
  /// Samples considered, and how many of them must agree.
  static constexpr int kSamples = 15, kAgreeing = 12;

  /// `largest_tolerance_m`: residual beyond which no sample fits.
  explicit BodyShape(Scalar largest_tolerance_m) : largest_tolerance_m_(largest_tolerance_m) {}

  /// Takes a sample's points, finite, one a column (m). Points that repeat the last ones bit for
  /// bit contain nothing new and do not count.
  void add(const Matrix3<Scalar>& points_m) {
    if (count_ > 0 && points_m == last_m_) return;
    last_m_ = points_m;
    distances_m_.col(next_) = distances_of(points_m);
    next_ = (next_ + 1) % kSamples;
    count_ = std::min(count_ + 1, kSamples);
    if (count_ == kSamples) judge();
  }

  /// True once enough samples were seen, whether they agree or not.
  bool has_seen_enough() const { return count_ == kSamples; }
  /// True if they agree; only then are the following results valid.
  bool is_settled() const { return is_settled_; }
  /// The body, in the jaw frame.
  RigidBody<Scalar> body() const { return RigidBody<Scalar>::from_distances(median_m_); }
  /// Residual beyond which a sample does not fit (m).
  Scalar tolerance_m() const { return tolerance_m_; }

 private:
  // The median of an odd number of values; changes their order.
  template <class Values>
  static Scalar median(Values& values) {
    Scalar* const middle = values.data() + values.size() / 2;
    std::nth_element(values.data(), middle, values.data() + values.size());
    return *middle;
  }

  void judge() {
    for (int k = 0; k < 3; ++k) {
      Eigen::Matrix<Scalar, kSamples, 1> row_m = distances_m_.row(k);
      median_m_[k] = median(row_m);
    }
    Eigen::Matrix<Scalar, 3, kSamples> deviations_m = distances_m_.colwise() - median_m_;
    const Eigen::Matrix<Scalar, kSamples, 1> misfits_m =
        deviations_m.colwise().norm() / std::sqrt(Scalar(6));
    deviations_m = deviations_m.cwiseAbs().eval();
    const Scalar spread_m = Scalar(1.4826) * median(deviations_m) / std::sqrt(Scalar(2));
    tolerance_m_ =
        std::min(std::max(6 * spread_m, Scalar(kSmallestTolerance_m)), largest_tolerance_m_);
    is_settled_ = (misfits_m.array() <= tolerance_m_).count() >= kAgreeing &&
                  3 * spread_m <= largest_tolerance_m_ && body().status() == PoseStatus::ok;
  }

  Scalar largest_tolerance_m_;
  Eigen::Matrix<Scalar, 3, kSamples> distances_m_;  // a sample a column, in turn
  int next_ = 0, count_ = 0;
  Matrix3<Scalar> last_m_ = Matrix3<Scalar>::Zero();
  Vector3<Scalar> median_m_ = Vector3<Scalar>::Zero();
  Scalar tolerance_m_ = 0;
  bool is_settled_ = false;
};

}  // namespace condyle
