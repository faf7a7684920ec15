// SPDX-License-Identifier: Apache-2.0
// The core against its dense twin, and its two forms against each other.
#include "condyle/estimator/published/cascade_core.h"

#include <random>

#include "support/dense_cascade.h"
#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::DenseCascade;
using testing_support::number_between;

struct Samples {
  std::vector<double> positions_m, steps_s;
};

// Chewing with 0.1 mm of noise and, every 50 samples, a position that is 30 mm off; about 60 Hz.
Samples chewing(unsigned seed, std::size_t count) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0, 1);
  Samples samples;
  double time_s = 0;
  for (std::size_t i = 0; i < count; ++i) {
    samples.steps_s.push_back((1 + 0.05 * noise(generator)) / 60);
    time_s += samples.steps_s.back();
    samples.positions_m.push_back(-0.0075 * (1 - std::cos(2 * M_PI * 1.3 * time_s)) +
                                  1e-4 * noise(generator) + (i % 50 == 49 ? 0.03 : 0));
  }
  return samples;
}

PublishedParameters random_parameters() {
  PublishedParameters p;
  p.motion.discretisation = *rc::gen::element(Discretisation::forward, Discretisation::backward);
  p.assumed_mass_kg = *number_between(0.15, 0.5);
  p.friction.initial_Ns_m = *number_between(0, 2);
  p.mass.initial_kg = *number_between(0.15, 0.5);
  const auto scale = [](auto& variances, double lowest) {
    for (double& variance : variances) variance *= std::pow(10, *number_between(lowest, 1));
  };
  const auto scale_stage = [&scale](auto& stage) {
    scale(stage.initial_variance, -1);
    scale(stage.process_variance, -1);
    scale(stage.measurement_variance, 0);  // smaller, the gate would reject what is good
  };
  scale_stage(p.motion);
  scale_stage(p.friction);
  scale_stage(p.mass);
  return p;
}

// Compares a stage with its twin and sets the twin to the stage, so that a mass close to zero,
// which multiplies differences without end, is compared step by step too.
template <class Dense>
void expect_same(const ThreeStateFilter<double>& filter, const Dense& dense) {
  using Wide = typename Dense::Vector::Scalar;
  for (int i = 0; i < 3; ++i) {
    const Wide sd = std::sqrt(dense.P(i, i));
    RC_ASSERT(std::abs(Wide(filter.x[i]) - dense.x[i]) <= 1e-10L * (sd + std::abs(dense.x[i])));
    for (int j = 0; j < 3; ++j) {
      RC_ASSERT(std::abs(Wide(filter.P(i, j)) - dense.P(i, j)) <=
                1e-10L * sd * std::sqrt(dense.P(j, j)));
    }
  }
}

// Sets the twin to the stage: each step is compared by itself.
template <class Dense>
void follow(const ThreeStateFilter<double>& filter, Dense& dense) {
  using Wide = typename Dense::Vector::Scalar;
  dense.x = filter.x.template cast<Wide>();
  dense.P = filter.P.dense().template cast<Wide>();
}

// The twin is wider: in double, its (I - K H) P loses digits that K R keeps.
RC_GTEST_PROP(CascadeCore, IsItsDenseTwin, ()) {
  const PublishedParameters parameters = random_parameters();
  const double gate = *number_between(50, 100);
  CascadeCore<double> core(parameters, gate);
  DenseCascade<long double> dense(parameters, gate);
  const Samples samples = chewing(*rc::gen::arbitrary<unsigned>(), 200);
  const auto close = [](double actual, long double expected) {
    return std::abs(actual - expected) <= 1e-9L * (1 + expected);
  };
  for (std::size_t i = 0; i < samples.positions_m.size(); ++i) {
    const double z = samples.positions_m[i], T = samples.steps_s[i];
    const double mass_before = i == 0 ? parameters.mass.initial_kg : core.mass().x[kThird];
    const CoreStep<double> step = core.step<CoreChecks::nis_and_gate>(z, T);
    const auto nis = dense.step<true>(z, T);
    RC_ASSERT(!step.refused);
    RC_ASSERT(step.rejected == nis.rejected);
    RC_ASSERT(step.motion_updated == !nis.rejected);
    expect_same(core.motion(), dense.motion);
    expect_same(core.friction(), dense.friction);
    if (!nis.rejected) {
      RC_ASSERT(close(step.motion_nis, nis.motion));
      RC_ASSERT(close(step.friction_nis, nis.friction));
    }
    // A mass at zero, where its model divides by zero, multiplies every difference.
    if (mass_before > 0.05) {
      expect_same(core.mass(), dense.mass);
      RC_ASSERT(nis.rejected || close(step.mass_nis, nis.mass));
    }
    follow(core.motion(), dense.motion);
    follow(core.friction(), dense.friction);
    follow(core.mass(), dense.mass);
  }
}

template <class Scalar>
bool same_bits(const CascadeCore<Scalar>& a, const CascadeCore<Scalar>& b) {
  const auto same = [](const auto& f, const auto& g) {
    return f.x == g.x && f.P.dense() == g.P.dense();
  };
  return same(a.motion(), b.motion()) && same(a.friction(), b.friction()) &&
         same(a.mass(), b.mass());
}

TEST(CascadeCore, ChecksDoNotChangeTheEstimates) {
  CascadeCore<float> bare{PublishedParameters{}}, checked{PublishedParameters{}};
  const Samples samples = chewing(1, 500);
  for (const double position_m : samples.positions_m) {
    const float z = static_cast<float>(position_m);
    EXPECT_TRUE(bare.step(z, 0.0167F));
    const auto step = checked.step<CoreChecks::nis_and_gate>(z, 0.0167F);
    EXPECT_TRUE(step.motion_updated && !step.refused && !step.rejected);
    ASSERT_TRUE(same_bits(bare, checked));
  }
}

TEST(CascadeCore, ARejectedMeasurementIsOnlyPredicted) {
  CascadeCore<double> rejecting(PublishedParameters{}, 20), predicting(PublishedParameters{}, 20);
  const Samples samples = chewing(2, 40);
  for (const double z : samples.positions_m) {
    static_cast<void>(rejecting.step<CoreChecks::nis_and_gate>(z, 0.0167));
    static_cast<void>(predicting.step<CoreChecks::nis_and_gate>(z, 0.0167));
  }
  const auto step = rejecting.step<CoreChecks::nis_and_gate>(1, 0.0167);
  predicting.predict(0.0167);
  EXPECT_TRUE(step.rejected);
  EXPECT_FALSE(step.refused || step.motion_updated);
  EXPECT_NEAR(step.innovation_m, 1, 0.05);
  EXPECT_TRUE(std::isnan(step.motion_nis) && std::isnan(step.mass_nis));
  EXPECT_TRUE(same_bits(rejecting, predicting));
}

TEST(CascadeCore, RefusesAnInnovationVarianceThatIsNotFinite) {
  CascadeCore<float> core{PublishedParameters{}};
  EXPECT_TRUE(core.step(0.01F, 0.0167F));
  core.predict(1e20F);  // its square is beyond float
  const CascadeCore<float> before = core;
  auto bare = before, predicted = before;
  const auto step = core.step<CoreChecks::nis_and_gate>(0.01F, 0.0167F);
  EXPECT_TRUE(step.refused);
  EXPECT_FALSE(step.motion_updated || step.rejected);
  EXPECT_TRUE(std::isnan(step.motion_nis) && std::isnan(step.friction_nis));
  EXPECT_FALSE(bare.step(0.01F, 0.0167F));
  predicted.predict(0.0167F);
  EXPECT_EQ(core.motion().x, predicted.motion().x);
  EXPECT_EQ(bare.motion().x, predicted.motion().x);
}

}  // namespace
}  // namespace condyle
