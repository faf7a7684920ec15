// SPDX-License-Identifier: Apache-2.0
// What widens the readings of short movements: abrupt parts, shortfalls and roughness of tops.
#include <gtest/gtest.h>

#include <cmath>
#include <string_view>
#include <vector>

#include "readings/abrupt_parts.h"
#include "readings/path_measures.h"
#include "readings/shortfalls.h"
#include "statistics/random.h"

namespace condyle::host {
namespace {

// A difference of the smoothings beyond noise, and what is around it.
TEST(AbruptParts, AreWhatNoiseDoesNotExplain) {
  constexpr double kNoise = 1e-5;
  constexpr std::size_t kSamples = 101, kAt = 50;
  RandomGenerator random(1);
  AbruptParts parts;
  SmoothMotion wide{{}, std::vector<Vector6>(kSamples, Vector6::Zero()), {}};
  for (std::size_t k = 0; k < kSamples; ++k) wide.time_s.push_back(0.01 * static_cast<double>(k));
  wide.slope = wide.value;
  SmoothMotion narrow = wide;
  EXPECT_TRUE(parts.of(narrow, wide).empty());  // the noise is not known
  for (int draw = 0; draw < 20; ++draw) {
    for (Vector6& value : narrow.value) {
      for (double& number : value) number = kNoise * random.normal();
    }
    parts.add_noise(narrow.value, wide.value);
  }
  EXPECT_TRUE(parts.of(narrow, wide).empty());
  narrow.value[kAt][1] = 10 * kNoise;
  narrow.slope[kAt][1] = 1;
  const std::vector<bool> is_abrupt = parts.of(narrow, wide);
  ASSERT_EQ(is_abrupt.size(), kSamples);
  for (std::size_t k = 0; k < kSamples; ++k) {
    EXPECT_EQ(is_abrupt[k], k >= kAt - 5 && k <= kAt + 5) << k;  // 0.05 s on both sides
  }
  const SmoothMotion mixed = narrowed_where(is_abrupt, narrow, wide);
  EXPECT_EQ(mixed.value[kAt], narrow.value[kAt]);
  EXPECT_EQ(mixed.slope[kAt], narrow.slope[kAt]);
  EXPECT_EQ(mixed.value[0], wide.value[0]);
}

TEST(Shortfalls, WidenTheirGreatestValues) {
  const std::vector<std::string_view> names = {"cycle_duration_s", "cycle_height_mm",
                                               "condylar_translation_difference_mm",
                                               "opening_deflection_mm"};
  std::vector<UncertainValue> values(7);
  for (UncertainValue& value : values) value.value = 10;
  values[2].contradiction = -2;
  values[3].contradiction = 0.5;
  values[4].value = 0.5;  // of the height
  values[4].noise_sd = 0.2;
  values[4].contradiction = 0.3;
  values[5].value = 0.1;  // of the difference, which noise explains
  values[5].noise_sd = 0.2;
  values[5].contradiction = 2;
  values[6].value = 0.5;  // of the deflection
  values[6].noise_sd = 0.2;
  values[6].contradiction_sd = 4;
  take_shortfalls(names, values);
  ASSERT_EQ(values.size(), names.size());
  EXPECT_EQ(values[0].half_interval(), 0);
  EXPECT_NEAR(values[1].doubt, 1.5 * std::sqrt(0.25 - 0.16), 1e-12);
  EXPECT_DOUBLE_EQ(values[1].contradiction, 0.3);
  EXPECT_EQ(values[2].doubt, 0);
  EXPECT_DOUBLE_EQ(values[2].contradiction, 4);  // it does not cancel
  EXPECT_NEAR(values[3].doubt, 1.5 * std::sqrt(0.25 - 0.16), 1e-12);
  EXPECT_EQ(values[3].contradiction_sd, 0);  // the noise at the top does not explain its own
}

TEST(Roughness, IsTheDistanceFromAParabola) {
  std::vector<double> time_s, smooth, rough;
  for (int k = 0; k < 101; ++k) {
    time_s.push_back(0.005 * k);
    const double x = time_s.back() - 0.25;
    smooth.push_back(1 - 3 * x * x);
    rough.push_back(smooth.back() + (k % 2 == 0 ? 1e-3 : -1e-3));
  }
  const Greatest top{50, 0.25, 1, 1};
  EXPECT_NEAR(roughness_of(time_s, smooth, top, 0.12), 0, 1e-12);
  EXPECT_NEAR(roughness_of(time_s, rough, top, 0.12), 1e-3, 5e-5);
  EXPECT_EQ(roughness_of(time_s, rough, top, 0.006), 0);  // three values
  EXPECT_EQ(roughness_of({0}, {1}, {0, 0, 1, 1}, 0.12), 0);
}

}  // namespace
}  // namespace condyle::host
