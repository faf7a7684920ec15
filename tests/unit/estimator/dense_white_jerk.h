// SPDX-License-Identifier: Apache-2.0
// The textbook's Kalman filter and Rauch-Tung-Striebel smoother of white-jerk motion: whole
// matrices with inverses, in metres and long double, sharing no line with the estimator.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <optional>
#include <vector>

#include "condyle/estimator/motion/motion_parameters.h"
#include "condyle/estimator/sample.h"

namespace condyle::testing_support {

using Real = long double;
using RealVector = Eigen::Matrix<Real, 3, 1>;
using RealMatrix = Eigen::Matrix<Real, 3, 3>;

/// Transition and process covariance (for density 1) of a step.
struct WhiteJerkMatrices {
  RealMatrix F, Q;
};

/// C. F. Van Loan, IEEE Trans. Autom. Control 23 (1978) 395-404: both from one exponential, whose
/// series ends by itself because the matrix is nilpotent.
inline WhiteJerkMatrices white_jerk_by_series(Real T) {
  using Matrix6 = Eigen::Matrix<Real, 6, 6>;
  Matrix6 generator = Matrix6::Zero();  // (-A, GG'; 0, A')
  generator(0, 1) = generator(1, 2) = -1;
  generator(2, 5) = 1;
  generator(4, 3) = generator(5, 4) = 1;
  Matrix6 term = Matrix6::Identity(), sum = term;
  for (int n = 1; n <= 6; ++n) {
    term = Matrix6(term * generator * (T / static_cast<Real>(n)));
    sum += term;
  }
  const RealMatrix F = sum.bottomRightCorner<3, 3>().transpose();
  return {F, F * sum.topRightCorner<3, 3>()};
}

/// State and covariance.
struct DenseMoments {
  RealVector x = RealVector::Zero();
  RealMatrix P = RealMatrix::Zero();
};

/// The filter.
struct DenseFilter : DenseMoments {
  Real R = 1, q = 1;

  void start(Real z, Real velocity_sd, Real acceleration_sd) {
    x = {z, 0, 0};
    P = RealVector(R, velocity_sd * velocity_sd, acceleration_sd * acceleration_sd).asDiagonal();
  }
  void predict(const WhiteJerkMatrices& model) {
    x = RealVector(model.F * x);
    P = RealMatrix(model.F * P * model.F.transpose() + q * model.Q);
  }
  Real innovation_variance() const { return P(0, 0) + R; }
  /// Joseph's form, the measurement variance divided by `weight`.
  void update(Real z, Real weight) {
    const Real R_used = R / weight;
    const RealVector K = P.col(0) / (P(0, 0) + R_used);
    RealMatrix C = RealMatrix::Identity();
    C.col(0) -= K;
    x = RealVector(x + K * (z - x[0]));
    P = RealMatrix(C * P * C.transpose() + K * R_used * K.transpose());
  }
};

/// A sample along one axis.
struct AxisSample {
  TimeNs time_ns = 0;
  bool is_measured = true;
  double position_m = 0;
};

/// What the recommended estimator should say along one axis, noise and jerk density known, where no
/// sample is beyond the gate.
class DenseTwin {
 public:
  explicit DenseTwin(const MotionEstimatorParameters& parameters) : parameters_(parameters) {
    filter_.R = std::pow(static_cast<Real>(parameters.noise.position_sd_m), 2);
    filter_.q = parameters.noise.jerk_density_m2_s5;
  }

  void step(const AxisSample& sample) {
    Instant instant;
    const bool is_reversed = !instants_.empty() && sample.time_ns < time_ns_;
    if (!is_reversed) {
      const double T = instants_.empty() ? 0 : seconds(sample.time_ns - time_ns_);
      time_ns_ = sample.time_ns;
      if (seconds(time_ns_ - taken_ns_) > parameters_.outliers.longest_gap_s) started_ = false;
      if (started_) {
        const WhiteJerkMatrices model = white_jerk_by_series(T);
        filter_.predict(model);
        instant.F = model.F;
      }
      instant.predicted = filter_;
      if (sample.is_measured && std::isfinite(sample.position_m)) take(sample, instant);
      instant.has_state = started_;
      instant.after = filter_;
    }
    instants_.push_back(instant);
  }

  /// State at sample `index` by all samples so far; nothing where there is no state.
  std::optional<DenseMoments> estimate(std::size_t index) const {
    if (!instants_[index].has_state) return std::nullopt;
    std::vector<const Instant*> chain;  // from `index` on, as far as the samples hang together
    for (std::size_t i = index; i < instants_.size(); ++i) {
      if (i > index && instants_[i].is_restart) break;
      if (instants_[i].has_state) chain.push_back(&instants_[i]);
    }
    DenseMoments smoothed = chain.back()->after;
    for (std::size_t i = chain.size() - 1; i-- > 0;) {
      const Instant &here = *chain[i], &next = *chain[i + 1];
      const RealMatrix G = here.after.P * next.F.transpose() * next.predicted.P.inverse();
      smoothed.x = RealVector(here.after.x + G * (smoothed.x - next.predicted.x));
      smoothed.P = RealMatrix(here.after.P + G * (smoothed.P - next.predicted.P) * G.transpose());
    }
    return smoothed;
  }

  int restarts() const { return restarts_; }
  int weighted() const { return weighted_; }

 private:
  struct Instant {
    bool has_state = false, is_restart = false;
    RealMatrix F = RealMatrix::Identity();
    DenseMoments predicted, after;
  };

  Real deviation_of(Real z) const {
    return std::abs(z - filter_.x[0]) / std::sqrt(filter_.innovation_variance());
  }

  void take(const AxisSample& sample, Instant& instant) {
    const double huber = parameters_.outliers.huber_sd;
    const Real z = sample.position_m;
    if (!started_) {
      filter_.start(z, parameters_.prior.velocity_sd_m_s, parameters_.prior.acceleration_sd_m_s2);
      restarts_ += has_started_;
      started_ = has_started_ = instant.is_restart = true;
    } else {
      const Real deviation = deviation_of(z);
      weighted_ += deviation > huber;
      filter_.update(z, deviation > huber ? huber / deviation : 1);
    }
    taken_ns_ = sample.time_ns;
  }

  MotionEstimatorParameters parameters_;
  DenseFilter filter_;
  std::vector<Instant> instants_;
  bool started_ = false, has_started_ = false;
  TimeNs time_ns_ = 0, taken_ns_ = 0;
  int restarts_ = 0, weighted_ = 0;
};

}  // namespace condyle::testing_support
