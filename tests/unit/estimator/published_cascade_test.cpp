// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/published/published_cascade.h"

#include <Eigen/Dense>
#include <random>

#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using Estimate = PublishedEstimate<double>;

// The three filters written down a second time, as a textbook would: full matrices, joint
// measurements, an inverse, and Jacobians by central differences.
class TextbookStage {
 public:
  using Vector = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;

  TextbookStage(Vector x0, const double* P0, const double* Q, const double* R, int measurements)
      : x(std::move(x0)), P(diagonal(P0, 3)), Q_(diagonal(Q, 3)), R_(diagonal(R, measurements)) {
    H_ = Matrix::Zero(measurements, 3);
    for (int i = 0; i < measurements; ++i) H_(i, i) = 1;
  }

  template <class Function>
  void predict(const Function& f) {
    Matrix J(3, 3);
    for (int j = 0; j < 3; ++j) {
      const double h = 1e-4 * std::max(1e-2, std::abs(x[j]));
      Vector above = x, below = x;
      above[j] += h;
      below[j] -= h;
      J.col(j) = (f(above) - f(below)) / (2 * h);
    }
    x = f(x);
    P = (J * P * J.transpose() + Q_).eval();
  }
  double update(const Vector& z) {
    const Matrix S = H_ * P * H_.transpose() + R_;
    const Vector innovation = z - H_ * x;
    const Matrix K = P * H_.transpose() * S.inverse();
    x += K * innovation;
    P = ((Matrix::Identity(3, 3) - K * H_) * P).eval();
    return innovation.dot(S.inverse() * innovation);
  }

  Vector x;
  Matrix P;

 private:
  static Matrix diagonal(const double* entries, int n) {
    return Eigen::Map<const Vector>(entries, n).asDiagonal();
  }
  Matrix Q_, R_, H_;
};

// A chewing-like position with 0.1 mm of noise, from a fixed seed; `phase` is where in the cycle it
// starts.
std::vector<double> chewing(unsigned seed, std::size_t samples, double phase = 0) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0, 1e-4);
  std::vector<double> positions;
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / 60;
    positions.push_back(-0.0075 * (1 - std::cos(2 * M_PI * 1.3 * t + phase)) + noise(generator));
  }
  return positions;
}

RC_GTEST_PROP(PublishedCascade, IsTheTextbooksThreeFilters, ()) {
  PublishedParameters p;
  p.sample_time_s = 1.0 / 60;
  p.motion.discretisation = *rc::gen::element(Discretisation::forward, Discretisation::backward);
  p.assumed_mass_kg = *testing_support::number_between(0.15, 0.5);
  const bool backward = p.motion.discretisation == Discretisation::backward;
  const double T = p.sample_time_s, m0 = p.assumed_mass_kg;
  using Vector = Eigen::VectorXd;

  PublishedCascade<double> cascade(p);
  const auto positions = chewing(*rc::gen::arbitrary<unsigned>(), 200);
  const auto stage = [&](const auto& s, double third, int measurements) {
    return TextbookStage(Eigen::Vector3d(positions[0], 0, third), s.initial_variance,
                         s.process_variance, s.measurement_variance, measurements);
  };
  TextbookStage motion = stage(p.motion, 0, 1),
                friction = stage(p.friction, p.friction.initial_Ns_m, 2),
                mass = stage(p.mass, p.mass.initial_kg, 2);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (i > 0) {
      motion.predict([&](const Vector& x) -> Vector {
        const double v = x[1] + T * x[2] / m0;
        return Eigen::Vector3d(x[0] + T * (backward ? v : x[1]), v, x[2]);
      });
    }
    const double motion_nis = motion.update(Vector::Constant(1, positions[i]));
    const double v1 = motion.x[1], u = motion.x[2];
    const Vector z = Eigen::Vector2d(positions[i], v1);
    if (i > 0) {
      friction.predict([&](const Vector& x) -> Vector {
        const double v = (x[1] + T * u / m0) / (1 + T * x[2] / m0);
        return Eigen::Vector3d(x[0] + T * v, v, x[2]);
      });
    }
    const double friction_nis = friction.update(z);
    if (i > 0) {
      const double kv = friction.x[2];
      mass.predict([&](const Vector& x) -> Vector {
        const double v = (x[2] * x[1] + T * u) / (x[2] + T * kv);
        return Eigen::Vector3d(x[0] + T * v, v, x[2]);
      });
    }
    const double mass_nis = mass.update(z);

    const Estimate estimate = cascade.step(positions[i]);
    const auto close = [](double a, double b, double scale) {
      return std::abs(a - b) <=
             1e-6 * (scale + std::abs(b));  // the twin's Jacobians are differences
    };
    RC_ASSERT(close(estimate.position_m.value, motion.x[0], 1e-3));
    RC_ASSERT(close(estimate.velocity_m_s.value, motion.x[1], 1e-2));
    RC_ASSERT(close(estimate.force_N.value, motion.x[2], 0.1));
    RC_ASSERT(close(estimate.friction_Ns_m.value, friction.x[2], 1e-3));
    RC_ASSERT(close(estimate.mass_kg.value, mass.x[2], 1e-2));
    RC_ASSERT(close(estimate.force_N.standard_deviation, std::sqrt(motion.P(2, 2)), 1e-3));
    RC_ASSERT(close(estimate.friction_Ns_m.standard_deviation, std::sqrt(friction.P(2, 2)), 1e-6));
    RC_ASSERT(close(estimate.mass_kg.standard_deviation, std::sqrt(mass.P(2, 2)), 1e-4));
    RC_ASSERT(close(estimate.motion_nis, motion_nis, 100));
    RC_ASSERT(close(estimate.friction_nis, friction_nis, 100));
    RC_ASSERT(close(estimate.mass_nis, mass_nis, 100));
    RC_ASSERT(estimate.events.empty());
  }
}

TEST(PublishedCascade, FirstSampleInitialises) {
  PublishedCascade<double> cascade(PublishedParameters{});
  const Estimate estimate = cascade.step(0.0123);
  EXPECT_EQ(estimate.position_m.value, 0.0123);
  EXPECT_EQ(estimate.velocity_m_s.value, 0);
  EXPECT_EQ(estimate.force_N.value, 0);
  EXPECT_EQ(estimate.friction_Ns_m.value, 0.022);
  EXPECT_EQ(estimate.mass_kg.value, 0.1);
  EXPECT_EQ(estimate.innovation_m, 0);
}

TEST(PublishedCascade, FrictionAndMassAreAlwaysAssumedAndForceDerivedOnceSeen) {
  PublishedCascade<double> cascade(PublishedParameters{});
  std::size_t index = 0;
  for (const double position_m : chewing(1, 500)) {
    const Estimate estimate = cascade.step(position_m);
    EXPECT_EQ(estimate.friction_Ns_m.provenance, Provenance::assumed);
    EXPECT_EQ(estimate.mass_kg.provenance, Provenance::assumed);
    EXPECT_EQ(estimate.position_m.provenance, Provenance::measured);
    // One position says nothing of velocity, two nothing of acceleration.
    EXPECT_EQ(estimate.velocity_m_s.provenance,
              index >= 1 ? Provenance::measured : Provenance::assumed);
    EXPECT_EQ(estimate.force_N.provenance, index >= 2 ? Provenance::derived : Provenance::assumed)
        << index;
    ++index;
  }
}

TEST(PublishedCascade, WithoutAMeasurementEverythingIsAssumed) {
  PublishedCascade<double> cascade(PublishedParameters{});
  for (const double position_m : chewing(1, 100)) static_cast<void>(cascade.step(position_m));
  for (int i = 0; i < 100; ++i) {
    const Estimate estimate = cascade.step_without_measurement();
    EXPECT_TRUE(estimate.events.empty());
    EXPECT_TRUE(std::isnan(estimate.motion_nis));
    for (const auto& quantity : {estimate.position_m, estimate.velocity_m_s, estimate.force_N}) {
      EXPECT_EQ(quantity.provenance, Provenance::assumed);
    }
  }
  EXPECT_EQ(cascade.step(-0.005).position_m.provenance, Provenance::measured);
}

// Friction 0 and the assumed mass reproduce every motion: that is why neither is measured.
// Different priors of friction stay apart on the same recording.
TEST(PublishedCascade, TheTuningDecidesTheFriction) {
  std::vector<double> settled;
  for (const double prior : {0.022, 0.5}) {
    PublishedParameters parameters;
    parameters.sample_time_s = 1.0 / 60;
    parameters.friction.initial_Ns_m = prior;
    PublishedCascade<double> cascade(parameters);
    Estimate estimate;
    for (const double position_m : chewing(1, 1800)) estimate = cascade.step(position_m);
    settled.push_back(estimate.friction_Ns_m.value);
  }
  EXPECT_GT(settled[1] / settled[0], 10);
}

TEST(PublishedCascade, NothingNotFiniteEntersAState) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    PublishedCascade<double> with_bad(PublishedParameters{}), predicting(PublishedParameters{});
    EXPECT_TRUE(with_bad.step(bad).events.has(Event::not_started));
    for (const double position_m : chewing(2, 50)) {
      static_cast<void>(with_bad.step(position_m));
      static_cast<void>(predicting.step(position_m));
    }
    const Estimate estimate = with_bad.step(bad);
    const Estimate predicted = predicting.step_without_measurement();
    EXPECT_TRUE(estimate.events.has(Event::position_missing));
    EXPECT_EQ(estimate.position_m.value, predicted.position_m.value);
    EXPECT_EQ(estimate.mass_kg.standard_deviation, predicted.mass_kg.standard_deviation);
    EXPECT_TRUE(std::isnan(estimate.innovation_m));
  }
}

// Whatever comes, a value stands with a finite standard deviation or does not stand at all.
template <class Scalar>
void expect_value_and_deviation_together(const PublishedEstimate<Scalar>& estimate) {
  for (const auto& quantity : {estimate.position_m, estimate.velocity_m_s, estimate.force_N,
                               estimate.friction_Ns_m, estimate.mass_kg}) {
    const bool computed = quantity.provenance != Provenance::not_computed;
    EXPECT_EQ(std::isfinite(quantity.value), computed);
    EXPECT_EQ(std::isfinite(quantity.standard_deviation), computed);
  }
}

TEST(PublishedCascade, SurvivesAbsurdPositions) {
  for (const double absurd : {1e308, -1e308, 1e300, 1e37, 1e-300, 5e-324}) {
    PublishedCascade<double> cascade(PublishedParameters{});
    PublishedCascade<float> in_float(PublishedParameters{});
    bool said = false;
    for (int i = 0; i < 100; ++i) {
      const double position_m = i % 2 == 0 ? -absurd : absurd;
      const Estimate estimate = cascade.step(position_m);
      expect_value_and_deviation_together(estimate);
      expect_value_and_deviation_together(in_float.step(static_cast<float>(position_m)));
      said = said || estimate.events.has(Event::estimate_not_finite) ||
             estimate.verdict == Verdict::diverged;
    }
    EXPECT_TRUE(said || std::abs(absurd) < 1e300) << absurd;
  }
}

// Backward stage 1, mass started at 0.1 kg, jaw already moving: the mass often becomes negative.
TEST(PublishedCascade, ADivergedMassIsSaid) {
  int diverged = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    PublishedParameters parameters;
    parameters.sample_time_s = 1.0 / 60;
    parameters.motion.discretisation = Discretisation::backward;
    PublishedCascade<double> cascade(parameters);
    bool was_negative = false;
    for (const double position_m : chewing(seed, 600, seed)) {
      const Estimate estimate = cascade.step(position_m);
      was_negative = was_negative || !(estimate.mass_kg.value > 0);
      EXPECT_EQ(estimate.verdict == Verdict::diverged, was_negative);
    }
    if (was_negative) ++diverged;
  }
  EXPECT_GT(diverged, 0) << "no run diverged, so nothing was shown";
}

}  // namespace
}  // namespace condyle
