// SPDX-License-Identifier: Apache-2.0
// The bank against textbook filters, and its noise and weights against their definitions.
#include "condyle/estimator/motion/motion_expectation.h"

#include <array>

#include "support/rapidcheck_gtest.h"
#include "unit/estimator/dense_white_jerk.h"

namespace condyle {
namespace {

using testing_support::DenseFilter;
using testing_support::number_between;
using testing_support::Real;
using testing_support::white_jerk_by_series;

// A sample, as shares of what is drawn from it.
struct Draw {
  double T, z, weight;
  bool is_measured;
};

rc::Gen<std::vector<Draw>> draws() {
  const auto draw = rc::gen::apply(
      [](double T, double z, double weight, int kind) {
        return Draw{T, z, kind % 3 == 0 ? weight : 1, kind != 1};
      },
      number_between(1e-4, 0.1), number_between(-0.02, 0.02), number_between(0.3, 1),
      rc::gen::inRange(0, 10));
  return rc::gen::noShrink(rc::gen::container<std::vector<Draw>>(40, draw));
}

// State and covariance, each in standard deviations of the textbook's; R is the bank's unit.
template <int kAxes>
double difference(const FilteredStep<double, kAxes>& step, int axis, double R,
                  const DenseFilter& expected) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const Real sd = std::sqrt(expected.P(i, i));
    worst = std::max(worst, static_cast<double>(std::abs(step.x[axis][i] - expected.x[i]) / sd));
    for (int j = 0; j < 3; ++j) {
      const Real unit = sd * std::sqrt(expected.P(j, j));
      const Real error = std::abs(R * step.P(i, j) - expected.P(i, j)) / unit;
      worst = std::max(worst, static_cast<double>(error));
    }
  }
  return worst;
}

MotionEstimatorParameters fixed_parameters() {
  MotionEstimatorParameters parameters;
  parameters.noise.adaptation = Adaptation::off;
  return parameters;
}

RC_GTEST_PROP(FilterBank, WithoutAdaptationIsTheTextbooksFilterInMetres, ()) {
  MotionEstimatorParameters parameters = fixed_parameters();
  const double sd = std::pow(10, *number_between(-5, -3));
  parameters.noise.jerk_density_m2_s5 = std::pow(10, *number_between(-1, 3));
  FilterBank<double, 1> bank(parameters);
  ASSERT_EQ(bank.member_count(), 1);
  DenseFilter filter;
  filter.R = static_cast<Real>(sd) * sd;
  filter.q = parameters.noise.jerk_density_m2_s5;

  bank.start_noise({sd});
  bank.start_motion({0.001}, 1);
  filter.start(0.001, parameters.prior.velocity_sd_m_s, parameters.prior.acceleration_sd_m_s2);
  for (const Draw& draw : *draws()) {
    bank.predict(white_jerk_jacobian(draw.T), white_jerk_covariance(draw.T));
    filter.predict(white_jerk_by_series(draw.T));
    RC_ASSERT(difference(bank.step(0), 0, sd * sd, filter) < 1e-8);
    if (draw.is_measured) {
      const auto expected = expectation(bank, 0, draw.z);
      RC_ASSERT(expected.position_m == bank.step(0).x[0][kPosition]);
      const double S = static_cast<double>(filter.innovation_variance());
      RC_ASSERT(std::abs(expected.variance_m2 - S) < 1e-9 * S);
      bank.learn({draw.z}, draw.T);
      RC_ASSERT(bank.update({draw.z}, draw.weight));
      filter.update(draw.z, draw.weight);
    }
    RC_ASSERT(difference(bank.step(0), 0, sd * sd, filter) < 1e-8);
    const auto moments = bank.moments(0);
    for (int i = 0; i < 3; ++i) {
      const double variance = static_cast<double>(filter.P(i, i));
      RC_ASSERT(std::abs(moments.variance[i] - variance) <= 1e-8 * variance);
      RC_ASSERT(moments.mean[i] == bank.step(0).x[0][i]);
    }
    RC_ASSERT(std::abs(bank.noise_variance_m2(0) - sd * sd) <= 1e-14 * sd * sd);
  }
}

// One filter for each axis' own noise: what it says of that axis alone is used.
RC_GTEST_PROP(FilterBank, WithoutAdaptationEachAxisHasItsOwnNoise, ()) {
  const MotionEstimatorParameters parameters = fixed_parameters();
  const double sd[] = {2e-5, 1e-4, 5e-4};
  FilterBank<double, 3> bank(parameters);
  ASSERT_EQ(bank.member_count(), 3);
  bank.start_noise({sd[0], sd[1], sd[2]});
  bank.start_motion({0.001, 0, -0.002}, 1);
  std::array<DenseFilter, 3> filters;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    filters[axis].R = static_cast<Real>(sd[axis]) * sd[axis];
    filters[axis].q = parameters.noise.jerk_density_m2_s5;
    filters[axis].start(axis == 0 ? 0.001L : axis == 1 ? 0.0L : -0.002L, 0.1L, 2);
  }
  for (const Draw& draw : *draws()) {
    bank.predict(white_jerk_jacobian(draw.T), white_jerk_covariance(draw.T));
    for (auto& filter : filters) filter.predict(white_jerk_by_series(draw.T));
    if (draw.is_measured) {
      RC_ASSERT(bank.update({draw.z, -draw.z, draw.z / 2}, draw.weight));
      filters[0].update(draw.z, draw.weight);
      filters[1].update(-draw.z, draw.weight);
      filters[2].update(draw.z / 2, draw.weight);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto& filter = filters[static_cast<std::size_t>(axis)];
      const auto moments = bank.moments(axis);
      for (int i = 0; i < 3; ++i) {
        const double variance = static_cast<double>(filter.P(i, i));
        RC_ASSERT(std::abs(moments.variance[i] - variance) <= 1e-8 * variance);
        RC_ASSERT(std::abs(moments.mean[i] - static_cast<double>(filter.x[i])) <=
                  1e-8 * std::sqrt(variance));
      }
    }
  }
}

constexpr int kMembers = FilterBank<double, 1>::kMostMembers;

// The bank's ratios follow the sample time (jerk_density_grid.h); these tests take them as they
// are.
template <int kAxes>
void take_ratios(const FilterBank<double, kAxes>& bank,
                 std::array<DenseFilter, kMembers>& filters) {
  for (int i = 0; i < kMembers; ++i) filters[static_cast<std::size_t>(i)].q = bank.ratio(i);
}

RC_GTEST_PROP(FilterBank, EachMemberIsTheTextbooksFilterInUnitsOfTheNoise, ()) {
  const MotionEstimatorParameters parameters;
  const double sd[] = {3e-4, 5e-5, 1e-4}, least = 5e-5;
  FilterBank<double, 3> bank(parameters);
  ASSERT_EQ(bank.member_count(), kMembers);
  bank.start_noise({sd[0], sd[1], sd[2]});
  bank.start_motion({0.001, 0, 0}, 1);
  std::array<DenseFilter, kMembers> filters;
  for (int i = 0; i < kMembers; ++i) {
    auto& filter = filters[static_cast<std::size_t>(i)];
    filter.start(0.001, parameters.prior.velocity_sd_m_s / least,
                 parameters.prior.acceleration_sd_m_s2 / least);
  }
  for (const Draw& draw : *draws()) {
    take_ratios(bank, filters);
    bank.predict(white_jerk_jacobian(draw.T), white_jerk_covariance(draw.T));
    const auto model = white_jerk_by_series(draw.T);
    for (auto& filter : filters) filter.predict(model);
    if (draw.is_measured) {
      bank.learn({draw.z, 0, 0}, draw.T);
      RC_ASSERT(bank.update({draw.z, 0, 0}, draw.weight));
      for (auto& filter : filters) filter.update(draw.z, draw.weight);
    }
    for (int i = 0; i < kMembers; ++i) {
      RC_ASSERT(difference(bank.step(i), 0, 1, filters[static_cast<std::size_t>(i)]) < 1e-7);
    }
  }
}

constexpr double kHighestIndexLog10 = 10;

// What the headers say of noise and weights, written down as sums over all samples so far.
class NoiseByDefinition {
 public:
  explicit NoiseByDefinition(const MotionEstimatorParameters& parameters)
      : parameters_(parameters) {
    R_.fill(std::pow(parameters.noise.position_sd_m, 2));
    double sum = 0;
    for (std::size_t i = 0; i < kMembers; ++i) {
      sum += weight_[i] = std::exp(-0.5 * static_cast<double>(i));
    }
    for (double& weight : weight_) weight /= sum;
  }

  template <class Filters>
  void learn(const Filters& filters, double z, double T) {
    n_ += 1.0 / 3;
    mean_step_s_ += mean_step_s_ > 0 ? (T - mean_step_s_) / n_ : T;
    n_ = std::max(5.0, std::min(n_, parameters_.noise.memory_s / mean_step_s_));
    const double huber = parameters_.outliers.huber_sd, gate = parameters_.outliers.gate_sd;
    std::array<double, kMembers> lasting, log_likelihood, S, square;
    double widest = -HUGE_VAL, least_square = HUGE_VAL;
    for (std::size_t i = 0; i < kMembers; ++i) {
      S[i] = static_cast<double>(filters[i].innovation_variance());
      square[i] = std::pow(z - static_cast<double>(filters[i].x[0]), 2) / (S[i] * R_[i]);
      widest = std::max(widest, std::log(R_[i] * S[i]));
      least_square = std::min(least_square, square[i]);
    }
    if (least_square > gate * gate) {  // expected by none
      for (double& R : R_) R = std::min(R * (1 + (huber * huber - 1) / n_), highest_R());
      n_ = std::max(0.9 * n_, 5.0);
      return;
    }
    repeats_ = z == last_z_ ? repeats_ + 1 : 0;
    last_z_ = z;
    const bool is_long_run = repeats_ >= 8;
    const bool is_fresh = fresh_ > 0;
    if (is_fresh) --fresh_;
    for (std::size_t i = 0; i < kMembers; ++i) {
      recent_[i] = recent_[i] * 7 / 8 -
                   0.5 * std::min(std::log(R_[i] * S[i]) + square[i], widest + gate * gate);
      if (!is_fresh && !is_long_run) {
        R_[i] *= 1 + (std::min(square[i], huber * huber) - 1) / n_;
        R_[i] = std::clamp(R_[i], std::pow(parameters_.noise.lowest_position_sd_m, 2), highest_R());
      }
      if (!is_fresh) {
        mean_log_S_[i] = (1 - 1 / n_) * mean_log_S_[i] + std::log(S[i]) / n_;
      }
      lasting[i] = -0.5 * 0.3 * n_ * (std::log(R_[i]) + mean_log_S_[i]);
    }
    leader_ = static_cast<std::size_t>(std::max_element(lasting.begin(), lasting.end()) -
                                       lasting.begin());
    for (std::size_t i = 0; i < kMembers; ++i) {
      log_likelihood[i] = std::max(lasting[i] - lasting[leader_],
                                   -6 - 0.5 * static_cast<double>(std::max(i, leader_) - leader_)) +
                          recent_[i];
    }
    const double best = *std::max_element(log_likelihood.begin(), log_likelihood.end());
    double sum = 0;
    for (std::size_t i = 0; i < kMembers; ++i) {
      sum += weight_[i] = std::exp(log_likelihood[i] - best);
    }
    for (double& weight : weight_) weight /= sum;
  }

  double noise_variance() const { return R_[leader_]; }
  std::size_t leader() const { return leader_; }
  // Members of less than a thousandth have no say.
  template <class Filters>
  MotionMoments<double> mixture(const Filters& filters) const {
    MotionMoments<double> mixed;
    double sum = 0;
    for (const double weight : weight_) sum += weight > 1e-3 ? weight : 0;
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t i = 0; i < kMembers; ++i) {
        if (weight_[i] <= 1e-3) continue;
        const Vector3<double> x = filters[i].x.template cast<double>();
        const Vector3<double> variance = filters[i].P.diagonal().template cast<double>();
        if (pass == 0) mixed.mean += weight_[i] / sum * x;
        if (pass == 1) {
          // What the leader's noise adds is at most 4 times the prior's variance.
          const double added_R = std::max(R_[leader_] - R_[i], 0.0);
          const Vector3<double> most(HUGE_VAL, 4 * std::pow(parameters_.prior.velocity_sd_m_s, 2),
                                     4 * std::pow(parameters_.prior.acceleration_sd_m_s2, 2));
          mixed.variance += weight_[i] / sum * n_ / (n_ - 2) *
                            (R_[i] * variance + (added_R * variance).cwiseMin(most) +
                             (x - mixed.mean).cwiseAbs2());
        }
      }
    }
    return mixed;
  }

 private:
  double highest_R() const { return std::pow(parameters_.noise.highest_position_sd_m, 2); }

  MotionEstimatorParameters parameters_;
  double n_ = 5, mean_step_s_ = 0;
  int fresh_ = 3, repeats_ = 0;
  double last_z_ = 0;
  std::size_t leader_ = kMembers / 2;
  std::array<double, kMembers> R_, mean_log_S_{}, recent_{}, weight_;
};

RC_GTEST_PROP(FilterBank, NoiseWeightsAndMixtureAreAsDefined, ()) {
  MotionEstimatorParameters parameters;
  parameters.noise.memory_s = *number_between(0.5, 20);
  FilterBank<double, 1> bank(parameters);
  bank.start_noise({parameters.noise.position_sd_m});
  bank.start_motion({0}, 1);
  NoiseByDefinition noise(parameters);
  std::array<DenseFilter, kMembers> filters;
  for (int i = 0; i < kMembers; ++i) {
    auto& filter = filters[static_cast<std::size_t>(i)];
    filter.start(0, parameters.prior.velocity_sd_m_s / parameters.noise.position_sd_m,
                 parameters.prior.acceleration_sd_m_s2 / parameters.noise.position_sd_m);
  }
  const double amplitude = std::pow(10, *number_between(-7, -2));
  for (const Draw& draw : *draws()) {
    take_ratios(bank, filters);
    bank.predict(white_jerk_jacobian(draw.T), white_jerk_covariance(draw.T));
    const auto model = white_jerk_by_series(draw.T);
    for (auto& filter : filters) filter.predict(model);
    if (draw.is_measured) {
      const double z = 50 * draw.z * amplitude;
      bank.learn({z}, draw.T);
      noise.learn(filters, z, draw.T);
      RC_ASSERT(bank.update({z}, 1));
      for (auto& filter : filters) filter.update(z, 1);
    }
    RC_ASSERT(std::abs(bank.noise_variance_m2(0) / noise.noise_variance() - 1) < 1e-6);
    const double density = noise.noise_variance() * bank.ratio(static_cast<int>(noise.leader()));
    RC_ASSERT(std::abs(bank.jerk_density_m2_s5(0) / density - 1) < 1e-6);
    const auto moments = bank.moments(0), expected = noise.mixture(filters);
    for (int i = 0; i < 3; ++i) {
      RC_ASSERT(std::abs(moments.variance[i] / expected.variance[i] - 1) < 1e-6);
      RC_ASSERT(std::abs(moments.mean[i] - expected.mean[i]) <
                1e-6 * std::sqrt(expected.variance[i]));
    }
  }
}

// Half decades below; above them up to a tracking index that the sample time sets.
TEST(FilterBank, ItsRatiosReachAsFarAtAnySampleTime) {
  for (const double T : {1e-3, 2.5e-3, 5e-3, 0.01, 1 / 60.0, 0.033}) {
    FilterBank<double, 1> bank(MotionEstimatorParameters{});
    bank.start_noise({5e-5});
    bank.start_motion({0}, 1);
    for (int i = 0; i < 50; ++i) {
      bank.predict(white_jerk_jacobian(T), white_jerk_covariance(T));
      bank.learn({0}, T);
      ASSERT_TRUE(bank.update({0}, 1));
    }
    EXPECT_NEAR(std::log10(bank.ratio(0)), 6.5, 1e-9);
    for (int i = 1; i < kMembers; ++i) EXPECT_GT(bank.ratio(i), bank.ratio(i - 1)) << T;
    EXPECT_NEAR(std::log10(bank.ratio(kMembers - 1) * std::pow(T, 5)), kHighestIndexLog10,
                5 * std::log10(1.5))
        << T;
  }
}

// However many there are: what they say of the members is nothing.
RC_GTEST_PROP(FilterBank, SamplesThatNoMemberExpectsLeaveTheWeights, ()) {
  FilterBank<double, 1> bank(MotionEstimatorParameters{});
  bank.start_noise({5e-5});
  bank.start_motion({0}, 1);
  const double T = *number_between(1e-3, 0.02);
  const auto step = [&] { bank.predict(white_jerk_jacobian(T), white_jerk_covariance(T)); };
  for (int i = 0; i < 200; ++i) {
    step();
    const double z = 0.005 * std::sin(8 * T * i);
    bank.learn({z}, T);
    RC_ASSERT(bank.update({z}, 1));
  }
  std::vector<double> before;
  for (int i = 0; i < kMembers; ++i) before.push_back(bank.weight(0, i));
  for (const double far : *rc::gen::container<std::vector<double>>(8, number_between(1, 2))) {
    const double noise = bank.noise_variance_m2(0);
    step();
    bank.learn({1e6 * far}, T);
    for (int i = 0; i < kMembers; ++i) {
      RC_ASSERT(bank.weight(0, i) == before[static_cast<std::size_t>(i)]);
    }
    RC_ASSERT(bank.noise_variance_m2(0) >= noise);
  }
}

}  // namespace
}  // namespace condyle
