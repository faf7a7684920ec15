// SPDX-License-Identifier: Apache-2.0
// condyle itself. "reported" is the cascade as the command uses it: with standard deviations, NIS,
// provenance and verdict.
#include "bench/peers/peer.h"
#include "condyle/estimator/published/cascade_core.h"
#include "condyle/estimator/published/published_cascade.h"

namespace condyle::peers {
namespace {

// Stage 1, as CascadeCore steps it.
class Stage1 {
 public:
  explicit Stage1(const PublishedParameters& parameters)
      : T_(parameters.sample_time_s),
        m0_(parameters.assumed_mass_kg),
        stage_(parameters.motion),
        Q_(stage_.process_variance[0], stage_.process_variance[1], stage_.process_variance[2]) {}

  MotionEstimates step(double z) {
    ThreeStateFilter<double> filter = filter_;
    if (started_) {
      filter.x = motion_transition(filter.x, T_, m0_, stage_.discretisation).state;
      propagate_motion_covariance(filter.P, T_, m0_, stage_.discretisation, Q_);
    } else {
      const double* variance = stage_.initial_variance;
      filter.initialise({z, 0, 0}, {variance[0], variance[1], variance[2]});
      started_ = true;
    }
    if (filter.update<kPosition>(z, stage_.measurement_variance[0]).refused) [[unlikely]] {
      throw std::runtime_error("stage 1 refused a measurement");
    }
    filter_ = filter;
    return {filter.x[kPosition], filter.x[kVelocity], filter.x[kThird]};
  }
  MotionEstimates variances() const {
    const auto& P = filter_.P;
    return {P(kPosition, kPosition), P(kVelocity, kVelocity), P(kThird, kThird)};
  }

 private:
  double T_, m0_;
  MotionParameters stage_;
  Vector3<double> Q_;
  bool started_ = false;
  ThreeStateFilter<double> filter_;
};

// Estimates alone.
class Cascade {
 public:
  explicit Cascade(const PublishedParameters& parameters)
      : T_(parameters.sample_time_s), core_(parameters) {}

  CascadeEstimates step(double z) {
    if (!core_.step(z, T_)) [[unlikely]] {
      throw std::runtime_error("the cascade refused a measurement");
    }
    const auto &motion = core_.motion().x, &friction = core_.friction().x, &mass = core_.mass().x;
    return {motion[kPosition], motion[kVelocity], motion[kThird], friction[kThird], mass[kThird]};
  }
  CascadeEstimates variances() const {
    const auto &motion = core_.motion().P, &friction = core_.friction().P, &mass = core_.mass().P;
    return {motion(kPosition, kPosition), motion(kVelocity, kVelocity), motion(kThird, kThird),
            friction(kThird, kThird), mass(kThird, kThird)};
  }

 private:
  double T_;
  CascadeCore<double> core_;
};

class Reported {
 public:
  explicit Reported(const PublishedParameters& parameters) : cascade_(parameters) {}

  CascadeEstimates step(double z) {
    last_ = cascade_.step(z);
    return {last_.position_m.value, last_.velocity_m_s.value, last_.force_N.value,
            last_.friction_Ns_m.value, last_.mass_kg.value};
  }
  CascadeEstimates variances() const {
    const auto square = [](const Quantity<double>& quantity) {
      return quantity.standard_deviation * quantity.standard_deviation;
    };
    return {square(last_.position_m), square(last_.velocity_m_s), square(last_.force_N),
            square(last_.friction_Ns_m), square(last_.mass_kg)};
  }

 private:
  PublishedCascade<double> cascade_;
  PublishedEstimate<double> last_;
};

}  // namespace
}  // namespace condyle::peers

int main(int argc, char** argv) {
  using namespace condyle::peers;
  return serve(argc, argv,
               {named<Stage1>("stage_1"), named<Cascade>("cascade"), named<Reported>("reported")});
}
