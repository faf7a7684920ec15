// SPDX-License-Identifier: Apache-2.0
// The cascade in Orocos' Bayesian Filtering Library: an ExtendedKalmanFilter for each stage. Stage
// 1's system and all measurements are linear analytic models; stages 2 and 3 are analytic
// conditional Gaussians with the model functions of friction_stage.h and mass_stage.h.
#include <bfl/filter/extendedkalmanfilter.h>
#include <bfl/model/linearanalyticmeasurementmodel_gaussianuncertainty.h>
#include <bfl/model/linearanalyticsystemmodel_gaussianuncertainty.h>
#include <bfl/pdf/analyticconditionalgaussian_additivenoise.h>
#include <bfl/pdf/linearanalyticconditionalgaussian.h>

#include <memory>

#include "bench/peers/peer.h"
#include "condyle/estimator/published/friction_stage.h"
#include "condyle/estimator/published/mass_stage.h"

namespace condyle::peers {
namespace {

using MatrixWrapper::ColumnVector;
using MatrixWrapper::Matrix;
using MatrixWrapper::SymmetricMatrix;

// Rows and columns count from 1.
ColumnVector column(std::initializer_list<double> values) {
  ColumnVector result(static_cast<int>(values.size()));
  unsigned row = 0;
  for (const double value : values) result(++row) = value;
  return result;
}
template <std::size_t n>
SymmetricMatrix diagonal(const double (&variances)[n]) {
  SymmetricMatrix result(static_cast<int>(n));
  result = 0.0;
  for (unsigned i = 0; i < n; ++i) result(i + 1, i + 1) = variances[i];
  return result;
}
template <std::size_t n>
BFL::Gaussian noise(const double (&variances)[n]) {
  return BFL::Gaussian(ColumnVector(static_cast<int>(n), 0.0), diagonal(variances));
}
// The first states.
Matrix first_states(int measurements) {
  Matrix H(measurements, 3);
  H = 0.0;
  for (unsigned i = 1; i <= static_cast<unsigned>(measurements); ++i) H(i, i) = 1;
  return H;
}
Vector3<double> vector(const ColumnVector& x) {
  return {x(1), x(2), x(3)};
}

// What the stages have in common: the measurement of the first states, and the filter.
template <std::size_t measurements>
class Stage {
 public:
  template <class Parameters>
  Stage(const Parameters& parameters, const ColumnVector& first)
      : measurement_pdf_(first_states(measurements), noise(parameters.measurement_variance)),
        measurement_(&measurement_pdf_),
        prior_(first, diagonal(parameters.initial_variance)),
        filter_(&prior_) {}

  void update(const ColumnVector& z) { filter_.Update(&measurement_, z); }
  template <class System>
  void predict_and_update(System& system, const ColumnVector& z) {
    filter_.Update(&system, &measurement_, z);
  }
  template <class System>
  void predict_and_update(System& system, const ColumnVector& u, const ColumnVector& z) {
    filter_.Update(&system, u, &measurement_, z);
  }
  ColumnVector estimates() { return filter_.PostGet()->ExpectedValueGet(); }
  SymmetricMatrix covariance() { return filter_.PostGet()->CovarianceGet(); }

 private:
  BFL::LinearAnalyticConditionalGaussian measurement_pdf_;
  BFL::LinearAnalyticMeasurementModelGaussianUncertainty measurement_;
  BFL::Gaussian prior_;
  BFL::ExtendedKalmanFilter filter_;
};

class Stage1 {
 public:
  explicit Stage1(const PublishedParameters& parameters)
      : system_pdf_(transition(parameters), noise(parameters.motion.process_variance)),
        system_(&system_pdf_),
        parameters_(parameters.motion) {}

  MotionEstimates step(double z) {
    if (!stage_) {
      stage_ = std::make_unique<Stage<1>>(parameters_, column({z, 0, 0}));
      stage_->update(column({z}));
    } else {
      stage_->predict_and_update(system_, column({z}));
    }
    const ColumnVector x = stage_->estimates();
    return {x(1), x(2), x(3)};
  }
  MotionEstimates variances() const {
    const SymmetricMatrix P = stage_->covariance();
    return {P(1, 1), P(2, 2), P(3, 3)};
  }

 private:
  static Matrix transition(const PublishedParameters& parameters) {
    const double T = parameters.sample_time_s, m0 = parameters.assumed_mass_kg;
    Matrix A(3, 3);
    A = 0.0;
    A(1, 1) = A(2, 2) = A(3, 3) = 1;
    A(1, 2) = T;
    A(2, 3) = T / m0;
    if (parameters.motion.discretisation == Discretisation::backward) A(1, 3) = T * T / m0;
    return A;
  }

  BFL::LinearAnalyticConditionalGaussian system_pdf_;
  BFL::LinearAnalyticSystemModelGaussianUncertainty system_;
  MotionParameters parameters_;
  std::unique_ptr<Stage<1>> stage_;
};

// p(x' | x, u) of stages 2 and 3: `Model` says the transition of a state under an input.
template <class Model>
class SystemPdf : public BFL::AnalyticConditionalGaussianAdditiveNoise {
 public:
  SystemPdf(const BFL::Gaussian& additive_noise, Model model)
      : AnalyticConditionalGaussianAdditiveNoise(additive_noise, 2), model_(model) {}

  ColumnVector ExpectedValueGet() const override {
    const Vector3<double> x = transition().state;
    return column({x[0], x[1], x[2]});
  }
  Matrix dfGet(unsigned) const override {
    const TransitionJacobian<double> J = transition().jacobian;
    Matrix F(3, 3);
    F(1, 1) = 1, F(1, 2) = J.pv, F(1, 3) = J.px;
    F(2, 1) = 0, F(2, 2) = J.vv, F(2, 3) = J.vx;
    F(3, 1) = 0, F(3, 2) = 0, F(3, 3) = 1;
    return F;
  }

 private:
  Transition<double> transition() const {
    return model_(vector(ConditionalArgumentGet(0)), ConditionalArgumentGet(1));
  }
  Model model_;
};

struct FrictionModel {
  double T, m0;
  Transition<double> operator()(const Vector3<double>& x, const ColumnVector& u) const {
    return friction_transition(x, u(1), T, m0);
  }
};
struct MassModel {
  double T;
  Transition<double> operator()(const Vector3<double>& x, const ColumnVector& u) const {
    return mass_transition(x, u(1), u(2), T);
  }
};

class Cascade {
 public:
  explicit Cascade(const PublishedParameters& parameters)
      : parameters_(parameters),
        motion_(parameters),
        friction_pdf_(noise(parameters.friction.process_variance),
                      {parameters.sample_time_s, parameters.assumed_mass_kg}),
        mass_pdf_(noise(parameters.mass.process_variance), {parameters.sample_time_s}),
        friction_system_(&friction_pdf_),
        mass_system_(&mass_pdf_) {}

  CascadeEstimates step(double z) {
    const MotionEstimates motion = motion_.step(z);
    const double v = motion[1], F = motion[2];
    const ColumnVector z_and_v = column({z, v});
    double kv = 0;
    if (!friction_) {
      const double kv0 = parameters_.friction.initial_Ns_m, m_init = parameters_.mass.initial_kg;
      friction_ = std::make_unique<Stage<2>>(parameters_.friction, column({z, 0, kv0}));
      mass_ = std::make_unique<Stage<2>>(parameters_.mass, column({z, 0, m_init}));
      friction_->update(z_and_v);
      mass_->update(z_and_v);
      kv = friction_->estimates()(3);
    } else {
      friction_->predict_and_update(friction_system_, column({F}), z_and_v);
      kv = friction_->estimates()(3);
      mass_->predict_and_update(mass_system_, column({F, kv}), z_and_v);
    }
    return {motion[0], v, F, kv, mass_->estimates()(3)};
  }
  CascadeEstimates variances() const {
    const MotionEstimates motion = motion_.variances();
    return {motion[0], motion[1], motion[2], friction_->covariance()(3, 3),
            mass_->covariance()(3, 3)};
  }

 private:
  PublishedParameters parameters_;
  Stage1 motion_;
  SystemPdf<FrictionModel> friction_pdf_;
  SystemPdf<MassModel> mass_pdf_;
  BFL::AnalyticSystemModelGaussianUncertainty friction_system_, mass_system_;
  std::unique_ptr<Stage<2>> friction_, mass_;
};

}  // namespace
}  // namespace condyle::peers

int main(int argc, char** argv) {
  using namespace condyle::peers;
  return serve(argc, argv, {named<Stage1>("stage_1"), named<Cascade>("cascade")});
}
