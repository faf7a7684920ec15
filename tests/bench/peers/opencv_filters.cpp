// SPDX-License-Identifier: Apache-2.0
// The cascade with cv::KalmanFilter in double precision. Stage 1 is linear. cv::KalmanFilter is
// not extended: stages 2 and 3 get the Jacobian as the transition matrix of each step, and the
// predicted state is overwritten with what friction_stage.h and mass_stage.h say.
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

#include "bench/peers/peer.h"
#include "condyle/estimator/published/friction_stage.h"
#include "condyle/estimator/published/mass_stage.h"

namespace condyle::peers {
namespace {

template <int n>
void set_diagonal(cv::Mat& matrix, const double (&variances)[static_cast<std::size_t>(n)]) {
  matrix = cv::Mat::zeros(n, n, CV_64F);
  for (int i = 0; i < n; ++i) matrix.at<double>(i, i) = variances[i];
}

// A filter with `measurements` of the first states.
template <int measurements>
class Stage {
 public:
  template <class Parameters>
  explicit Stage(const Parameters& parameters)
      : filter_(3, measurements, 0, CV_64F), z_(measurements, 1) {
    set_diagonal<3>(filter_.errorCovPre, parameters.initial_variance);
    set_diagonal<3>(filter_.processNoiseCov, parameters.process_variance);
    set_diagonal<measurements>(filter_.measurementNoiseCov, parameters.measurement_variance);
    cv::setIdentity(filter_.measurementMatrix);
  }

  /// First state: the sample that follows is taken without prediction.
  void start(double p, double v, double third) {
    state(filter_.statePre, 0) = p;
    state(filter_.statePre, 1) = v;
    state(filter_.statePre, 2) = third;
  }
  void predict() { filter_.predict(); }
  void predict(const Transition<double>& transition) {
    const TransitionJacobian<double>& J = transition.jacobian;
    cv::Mat& A = filter_.transitionMatrix;
    A.at<double>(0, 1) = J.pv, A.at<double>(0, 2) = J.px;
    A.at<double>(1, 1) = J.vv, A.at<double>(1, 2) = J.vx;
    filter_.predict();
    for (int i = 0; i < 3; ++i) state(filter_.statePre, i) = transition.state[i];
  }
  void correct(double z) {
    z_(0) = z;
    correct();
  }
  void correct(double z, double v) {
    z_(0) = z;
    z_(1) = v;
    correct();
  }
  Vector3<double> estimates() const {
    const cv::Mat& x = filter_.statePost;
    return {x.at<double>(0), x.at<double>(1), x.at<double>(2)};
  }
  double variance(int i) const { return filter_.errorCovPost.at<double>(i, i); }
  cv::Mat& transition_matrix() { return filter_.transitionMatrix; }

 private:
  void correct() {
    filter_.correct(z_);
    // It subtracts a symmetric matrix and takes the gain from rows: what rounding makes unsymmetric
    // would stay, and grow with the transitions.
    cv::completeSymm(filter_.errorCovPost);
  }
  static double& state(cv::Mat& x, int i) { return x.at<double>(i); }

  cv::KalmanFilter filter_;
  cv::Mat_<double> z_;
};

class Stage1 {
 public:
  explicit Stage1(const PublishedParameters& parameters) : stage_(parameters.motion) {
    const double T = parameters.sample_time_s, m0 = parameters.assumed_mass_kg;
    cv::Mat& A = stage_.transition_matrix();
    A.at<double>(0, 1) = T;
    A.at<double>(1, 2) = T / m0;
    if (parameters.motion.discretisation == Discretisation::backward) {
      A.at<double>(0, 2) = T * T / m0;
    }
  }

  MotionEstimates step(double z) {
    if (started_) {
      stage_.predict();
    } else {
      stage_.start(z, 0, 0);
      started_ = true;
    }
    stage_.correct(z);
    const Vector3<double> x = stage_.estimates();
    return {x[0], x[1], x[2]};
  }
  MotionEstimates variances() const {
    return {stage_.variance(0), stage_.variance(1), stage_.variance(2)};
  }

 private:
  bool started_ = false;
  Stage<1> stage_;
};

class Cascade {
 public:
  explicit Cascade(const PublishedParameters& parameters)
      : parameters_(parameters),
        motion_(parameters),
        friction_(parameters.friction),
        mass_(parameters.mass) {}

  CascadeEstimates step(double z) {
    const double T = parameters_.sample_time_s, m0 = parameters_.assumed_mass_kg;
    const MotionEstimates motion = motion_.step(z);
    const double v = motion[1], F = motion[2];
    if (started_) {
      friction_.predict(friction_transition(friction_.estimates(), F, T, m0));
    } else {
      friction_.start(z, 0, parameters_.friction.initial_Ns_m);
    }
    friction_.correct(z, v);
    const double kv = friction_.estimates()[kThird];
    if (started_) {
      mass_.predict(mass_transition(mass_.estimates(), F, kv, T));
    } else {
      mass_.start(z, 0, parameters_.mass.initial_kg);
    }
    mass_.correct(z, v);
    started_ = true;
    return {motion[0], v, F, kv, mass_.estimates()[kThird]};
  }
  CascadeEstimates variances() const {
    const MotionEstimates motion = motion_.variances();
    return {motion[0], motion[1], motion[2], friction_.variance(2), mass_.variance(2)};
  }

 private:
  PublishedParameters parameters_;
  bool started_ = false;
  Stage1 motion_;
  Stage<2> friction_, mass_;
};

}  // namespace
}  // namespace condyle::peers

int main(int argc, char** argv) {
  using namespace condyle::peers;
  return serve(argc, argv, {named<Stage1>("stage_1"), named<Cascade>("cascade")});
}
