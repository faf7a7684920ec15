// SPDX-License-Identifier: Apache-2.0
// The textbook's filter in plain Eigen (dense_cascade.h): compiled with Eigen's and the compiler's
// own settings, and with condyle's.
#include <Eigen/LU>
#ifndef EIGEN_DONT_VECTORIZE
#define EIGEN_DONT_VECTORIZE  // condyle's parameters ask for it; Eigen has been read without it
#endif
#include "bench/peers/peer.h"
#include "support/dense_cascade.h"

namespace condyle::peers {
namespace {

class Stage1 {
 public:
  explicit Stage1(const PublishedParameters& parameters)
      : T_(parameters.sample_time_s), cascade_(parameters) {}

  MotionEstimates step(double z) {
    cascade_.step_motion(z, T_);
    const auto& x = cascade_.motion.x;
    return {x[0], x[1], x[2]};
  }
  MotionEstimates variances() const {
    const auto& P = cascade_.motion.P;
    return {P(0, 0), P(1, 1), P(2, 2)};
  }

 private:
  double T_;
  testing_support::DenseCascade<double> cascade_;
};

class Cascade {
 public:
  explicit Cascade(const PublishedParameters& parameters)
      : T_(parameters.sample_time_s), cascade_(parameters) {}

  CascadeEstimates step(double z) {
    cascade_.step<false>(z, T_);
    const auto& x = cascade_.motion.x;
    return {x[0], x[1], x[2], cascade_.friction.x[2], cascade_.mass.x[2]};
  }
  CascadeEstimates variances() const {
    const auto& P = cascade_.motion.P;
    return {P(0, 0), P(1, 1), P(2, 2), cascade_.friction.P(2, 2), cascade_.mass.P(2, 2)};
  }

 private:
  double T_;
  testing_support::DenseCascade<double> cascade_;
};

}  // namespace
}  // namespace condyle::peers

int main(int argc, char** argv) {
  using namespace condyle::peers;
  return serve(argc, argv, {named<Stage1>("stage_1"), named<Cascade>("cascade")});
}
