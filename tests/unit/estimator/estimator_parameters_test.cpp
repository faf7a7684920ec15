// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "condyle/estimator/published/published_cascade.h"

namespace condyle {
namespace {

TEST(Parameters, DefaultsAreValid) {
  EXPECT_TRUE(is_valid(PublishedParameters{}));
}

// All stages follow the same position, so they trust it alike.
TEST(Parameters, StagesAgreeOnPositionAndVelocity) {
  const PublishedParameters parameters;
  for (int i = 0; i < 2; ++i) {
    for (const double* variance :
         {parameters.friction.initial_variance, parameters.mass.initial_variance}) {
      EXPECT_EQ(variance[i], parameters.motion.initial_variance[i]) << i;
    }
    for (const double* variance :
         {parameters.friction.process_variance, parameters.mass.process_variance}) {
      EXPECT_EQ(variance[i], parameters.motion.process_variance[i]) << i;
    }
    EXPECT_EQ(parameters.friction.measurement_variance[i], parameters.mass.measurement_variance[i]);
  }
  EXPECT_EQ(parameters.friction.measurement_variance[0], parameters.motion.measurement_variance[0]);
}

// Every field, pushed out of its range in turn, makes the parameters invalid, and the cascade says
// so instead of computing.
TEST(Parameters, EveryFieldIsChecked) {
  PublishedParameters parameters;
  int fields = 0;
  visit_fields(parameters, [&](const char* section, const char* key, double* values,
                               std::size_t count, const char*, Range range) {
    for (std::size_t i = 0; i < count; ++i) {
      const double good = values[i];
      for (const double bad : {range.lowest - 1e-3, 2 * range.highest, std::nan(""), HUGE_VAL}) {
        values[i] = bad;
        EXPECT_FALSE(is_valid(parameters)) << section << "." << key << " = " << bad;
        PublishedCascade<double> cascade(parameters);
        const auto estimate = cascade.step(0.001);
        EXPECT_TRUE(estimate.events.has(Event::parameters_invalid));
        EXPECT_EQ(estimate.position_m.provenance, Provenance::not_computed);
        EXPECT_TRUE(std::isnan(estimate.position_m.value));
      }
      values[i] = good;
      ++fields;
    }
  });
  EXPECT_EQ(fields, 27);
  EXPECT_TRUE(is_valid(parameters));
}

}  // namespace
}  // namespace condyle
