// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/sensors/recommended_parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "condyle/estimator/motion/recommended_estimator.h"
#include "condyle/estimator/sensors/cycle_sensor.h"
#include "condyle/estimator/sensors/driven_sensor.h"
#include "support/paths.h"

namespace condyle {
namespace {

// Says nothing but that the parameters are invalid, however long one waits.
void expect_nothing_computed(const MotionEstimatorParameters& parameters, int lag) {
  RecommendedEstimator<double, 1> estimator(parameters, lag);
  for (TimeNs i = 0; i < 20; ++i) {
    const auto estimate = estimator.step({i * 10'000'000, true, {0.001}, {}});
    EXPECT_TRUE(estimate.events.has(Event::parameters_invalid));
    for (const auto& axis : estimate.axes) {
      for (const auto* quantity :
           {&axis.position_m, &axis.velocity_m_s, &axis.acceleration_m_s2, &axis.force_N}) {
        EXPECT_EQ(quantity->provenance, Provenance::not_computed);
        EXPECT_TRUE(std::isnan(quantity->value) && std::isnan(quantity->standard_deviation));
      }
      EXPECT_TRUE(std::isnan(axis.noise_sd_m) && std::isnan(axis.innovation_m));
    }
    EXPECT_TRUE(std::isnan(estimate.nis));
  }
  EXPECT_TRUE(estimator.skip({}, false).events.has(Event::parameters_invalid));
  RecommendedEstimate<double> left;
  EXPECT_FALSE(estimator.drain(left));
}

// A sensor looks at all that it uses.
void expect_sensors_refuse(const RecommendedParameters& parameters) {
  const MotionEstimatorParameters& motion = parameters;
  const DrivenParameters& driven = parameters;
  if (!is_valid(motion)) expect_nothing_computed(motion, 0);
  const Sample sample;
  const auto says = [&sample](auto&& sensor) {
    return sensor.process(sample, {}).events.has(Event::parameters_invalid);
  };
  EXPECT_EQ(says(DrivenSensor<double, 1>(driven, 0, {}, 0)), !is_valid(driven));
  EXPECT_TRUE(says(CycleSensor<double, 1>(parameters, {}, 0)));
}

TEST(RecommendedParameters, DefaultsAreValid) {
  EXPECT_TRUE(is_valid(RecommendedParameters{}));
}

// The page for users lists all parameters of the motion with their defaults.
TEST(RecommendedParameters, DefaultsAreThoseOfThePage) {
  std::stringstream page;
  page << std::ifstream(testing_support::source_path("/host_sim/docs/estimates.md")).rdbuf();
  const std::string text = page.str();
  const std::size_t begin = text.find("```toml estimator.toml");
  ASSERT_NE(begin, std::string::npos);
  const std::string list = text.substr(begin, text.find("```\n", begin + 3) - begin);
  const MotionEstimatorParameters parameters;
  visit_motion_fields(parameters, [&list](const std::string& section, const std::string& key,
                                          const double* value, std::size_t, const char*, Range) {
    const std::size_t from = section.empty() ? 0 : list.find("[" + section + "]");
    ASSERT_NE(from, std::string::npos) << section;
    std::size_t place = list.find("\n" + key + " = ", from);
    if (place == std::string::npos) place = list.find("\n# " + key + " = ", from);
    ASSERT_LT(place, list.find("\n[", from + 1)) << section << "." << key;
    EXPECT_EQ(std::stod(list.substr(list.find('=', place) + 1)), *value) << section << "." << key;
  });
}

TEST(RecommendedParameters, EveryFieldIsChecked) {
  RecommendedParameters parameters;
  int fields = 0;
  visit_recommended_fields(parameters, [&](const char* section, const char* key, double* values,
                                           std::size_t count, const char*, Range range) {
    ASSERT_EQ(count, 1U);
    const double good = *values;
    EXPECT_TRUE(range.contains(good)) << section << "." << key;
    for (const double bad :
         {range.lowest - 1e-3, 2 * range.highest, std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      *values = bad;
      EXPECT_FALSE(is_valid(parameters)) << section << "." << key << " = " << bad;
      expect_sensors_refuse(parameters);
    }
    *values = good;
    ++fields;
  });
  EXPECT_EQ(fields, 57);
  EXPECT_TRUE(is_valid(parameters));
}

TEST(RecommendedParameters, EveryFieldsLimitsAreValid) {
  RecommendedParameters parameters;
  visit_recommended_fields(parameters, [&](const char*, const char* key, double* values,
                                           std::size_t, const char*, Range range) {
    const double good = *values;
    for (const double limit : {range.lowest, range.highest}) {
      *values = limit;
      // These four are also held against each other.
      const bool is_paired = std::string(key).find("est_position_sd_m") != std::string::npos ||
                             std::string(key) == "huber_sd" || std::string(key) == "gate_sd";
      EXPECT_TRUE(is_paired || is_valid(parameters)) << key << " = " << limit;
    }
    *values = good;
  });
}

TEST(RecommendedParameters, FieldsFitTogether) {
  RecommendedParameters parameters;
  parameters.noise.lowest_position_sd_m = parameters.noise.highest_position_sd_m;
  EXPECT_FALSE(is_valid(parameters));
  expect_nothing_computed(parameters, 0);
  parameters = {};
  parameters.outliers.gate_sd = parameters.outliers.huber_sd;
  EXPECT_TRUE(is_valid(parameters));
  parameters.outliers.gate_sd = 2.9;
  EXPECT_FALSE(is_valid(parameters));
  expect_nothing_computed(parameters, 3);
}

TEST(RecommendedParameters, TheLagIsChecked) {
  for (const int lag : {-1, 17, 1000000, -1000000}) expect_nothing_computed({}, lag);
  for (const int lag : {0, 16}) {
    RecommendedEstimator<double, 1> estimator({}, lag);
    EXPECT_TRUE(estimator.step({0, true, {0.001}, {}}).events.empty());
    EXPECT_EQ(estimator.lag(), lag);
  }
}

}  // namespace
}  // namespace condyle
