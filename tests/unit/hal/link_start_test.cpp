// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "unit/hal/link_round_trip.h"

namespace condyle::hal {
namespace {

using namespace testing_support;

StartMessage start(EstimatorChoice estimator) {
  StartMessage message;
  message.estimator = estimator;
  message.lag = 5;
  message.followed = {2, Axis::y};
  message.nominal_step_ns = 2'000'000;
  message.expects_drive = true;
  message.published.motion.discretisation = Discretisation::backward;
  message.recommended.noise.adaptation = Adaptation::off;
  message.recommended.impedance.delay = DelayModel::fitted;
  // Each value another one, in its range.
  double share = 0;
  const auto change = [&share](const char*, const char*, double* values, std::size_t count,
                               const char*, Range range) {
    for (std::size_t i = 0; i < count; ++i) {
      share += 1e-4;
      values[i] = values[i] == 0 ? range.highest * share : values[i] * (1 - share);
    }
  };
  visit_fields(message.published, change);
  visit_driven_fields(message.recommended, change);
  message.recommended.learning.kernels = 63.5;
  return message;
}

template <class Parameters, class Visit>
std::vector<double> values_of(const Parameters& parameters, Visit visit) {
  std::vector<double> all;
  visit(parameters, [&all](const char*, const char*, const double* values, std::size_t count,
                           const char*, Range) { all.insert(all.end(), values, values + count); });
  return all;
}

void expect_settings(const StartMessage& message, EstimatorChoice estimator) {
  EXPECT_EQ(message.estimator, estimator);
  EXPECT_EQ(message.lag, 5);
  EXPECT_EQ(message.followed.point, 2);
  EXPECT_EQ(message.followed.axis, Axis::y);
  EXPECT_EQ(message.nominal_step_ns, 2'000'000);
  EXPECT_TRUE(message.expects_drive);
}

TEST(LinkMessages, StartsArriveWithTheParametersOfTheRun) {
  const auto published = [](const auto& parameters, auto visitor) {
    visit_fields(parameters, visitor);
  };
  const StartMessage a = start(EstimatorChoice::published), b = sent(a);
  expect_settings(b, EstimatorChoice::published);
  EXPECT_EQ(b.published.motion.discretisation, Discretisation::backward);
  EXPECT_EQ(values_of(a.published, published), values_of(b.published, published));
  expect_each_byte_counts(a);

  const auto motion = [](const auto& parameters, auto visitor) {
    visit_motion_fields(parameters, visitor);
  };
  const auto driven = [](const auto& parameters, auto visitor) {
    visit_driven_fields(parameters, visitor);
  };
  StartMessage c = start(EstimatorChoice::recommended);
  c.identifies = true;
  const StartMessage d = sent(c);
  expect_settings(d, EstimatorChoice::recommended);
  EXPECT_EQ(d.recommended.noise.adaptation, Adaptation::off);
  EXPECT_EQ(d.recommended.impedance.delay, DelayModel::fitted);
  EXPECT_EQ(values_of(c.recommended, driven), values_of(d.recommended, driven));
  EXPECT_EQ(d.recommended.learning.kernels, 63.5);
  expect_each_byte_counts(c);

  c.identifies = false;
  const StartMessage e = sent(c);
  EXPECT_EQ(values_of(c.recommended, motion), values_of(e.recommended, motion));
  EXPECT_EQ(values_of(StartMessage{}.recommended.impedance,
                      [](const auto& impedance, auto visitor) {
                        visit_impedance_fields(impedance, visitor);
                      }),
            values_of(e.recommended.impedance,
                      [](const auto& impedance, auto visitor) {
                        visit_impedance_fields(impedance, visitor);
                      }))
      << "they are not sent";
  expect_each_byte_counts(c);
}

TEST(LinkMessages, RefusesStartsThatCannotRun) {
  const auto refused = [](EstimatorChoice estimator, auto spoil, RefusalReason reason,
                          int index = -1) {
    StartMessage message = start(estimator);
    spoil(message);
    expect_refused(message, reason, index);
  };
  const EstimatorChoice published = EstimatorChoice::published;
  const EstimatorChoice recommended = EstimatorChoice::recommended;
  const RefusalReason range = RefusalReason::out_of_range;
  refused(
      static_cast<EstimatorChoice>(2), [](auto&) {}, RefusalReason::unknown_value, 0);
  refused(
      recommended, [](auto& m) { m.lag = 17; }, range, 1);
  refused(
      recommended, [](auto& m) { m.followed.point = 0; }, range, 2);
  refused(
      recommended, [](auto& m) { m.followed.point = 4; }, range, 2);
  refused(
      recommended, [](auto& m) { m.followed.axis = static_cast<Axis>(3); },
      RefusalReason::unknown_value, 3);
  refused(
      recommended, [](auto& m) { m.nominal_step_ns = -1; }, range, 4);
  refused(
      recommended, [](auto& m) { m.nominal_step_ns = kMaxNominalStepNs + 1; }, range, 4);
  refused(
      published, [](auto& m) { m.published.sample_time_s = 0; }, range, 8);
  refused(
      published, [](auto& m) { m.published.mass.initial_kg = kNaN; }, RefusalReason::not_finite);
  refused(
      recommended, [](auto& m) { m.recommended.assumed_mass_kg = -1; }, range, 8);
  refused(
      recommended, [](auto& m) { m.recommended.learning.kernels = kMostKernels + 1; }, range);
  refused(
      recommended,
      [](auto& m) {
        m.identifies = true;
        m.recommended.impedance.friction_Ns_m.mean = kInfinity;
      },
      RefusalReason::not_finite);
  refused(
      recommended, [](auto& m) { m.recommended.outliers.huber_sd = 99; },
      RefusalReason::parameters_do_not_fit);
  StartMessage untouched = start(recommended);
  untouched.recommended.assumed_mass_kg = kNaN;
  untouched.estimator = published;
  StartMessage received;
  EXPECT_EQ(get(written(untouched), received).reason, RefusalReason::none) << "is not sent";
}

}  // namespace
}  // namespace condyle::hal
