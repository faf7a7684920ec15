// SPDX-License-Identifier: Apache-2.0
// The identification of a point: what it finds without noise, and what gaps, contacts and bad
// samples do to it.
#include "condyle/estimator/impedance/point_identification.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "unit/estimator/chewing_point.h"

namespace condyle {
namespace {

using testing_support::ChewingPoint;
using testing_support::exact;
using testing_support::identify;
using testing_support::kAsItIs;

void expect_truth(const ImpedanceEstimate<double>& estimate, const ChewingPoint& chewing) {
  const auto expect = [](const IdentifiedValue<double>& value, double truth) {
    EXPECT_EQ(value.limit, ImpedanceLimit::none) << limit_name(value.limit);
    EXPECT_NEAR(value.fitted, truth, 4 * value.fitted_sd);
  };
  expect(estimate.friction_Ns_m, chewing.friction_Ns_m);
  expect(estimate.mass_kg, chewing.mass_kg);
  expect(estimate.stiffness_N_m, chewing.stiffness_N_m);
  expect(estimate.offset_N, chewing.offset_N);
}

TEST(PointIdentification, FindsThePointWhereDriveAndPositionsComeApart) {
  for (const ChewingPoint& chewing :
       {ChewingPoint{}, ChewingPoint{.mass_kg = 0.08, .friction_Ns_m = 0.7, .stiffness_N_m = 0},
        ChewingPoint{.mass_kg = 0.6, .friction_Ns_m = 0, .stiffness_N_m = 120, .offset_N = -1}}) {
    const auto found = identify<double>(exact(), chewing, 20, kAsItIs);
    expect_truth(found->estimate(), chewing);
    EXPECT_NEAR(found->estimate().drive_noise_sd_N, 1e-3, 1e-4);
    EXPECT_NEAR(found->estimate().position_noise_sd_m, 1e-5, 2e-6);
    EXPECT_LT(found->estimate().mass_kg.fitted_sd, 0.004 * chewing.mass_kg);
  }
}

// A force that was never measured may change every value.
TEST(PointIdentification, MeasuresNothingWhileTheMissingForceIsUnknown) {
  ImpedanceParameters parameters = exact();
  parameters.drive.missing_share = 1;
  for (const bool is_everything_fitted : {false, true}) {
    if (is_everything_fitted) {
      parameters.delay = DelayModel::fitted;
      parameters.coulomb_N.sd = 0.1;
    }
    const auto estimate = identify<double>(parameters, {}, 20, kAsItIs)->estimate();
    for (const auto* value : {&estimate.friction_Ns_m, &estimate.mass_kg, &estimate.stiffness_N_m,
                              &estimate.offset_N, &estimate.coulomb_N, &estimate.delay_s}) {
      EXPECT_NE(value->quantity.provenance, Provenance::measured);
      EXPECT_NE(value->limit, ImpedanceLimit::none);
    }
    EXPECT_EQ(estimate.stiffness_N_m.limit, ImpedanceLimit::missing);
  }
}

// Half of the force measured, and stated so: twice the measured force may be at work.
TEST(PointIdentification, TakesTheMissingShareOfTheTotal) {
  ImpedanceParameters parameters = exact();
  const ChewingPoint half{
      .mass_kg = 0.125, .friction_Ns_m = 0.025, .stiffness_N_m = 10, .offset_N = 0.05};
  for (const double share : {0.1, 0.5}) {
    parameters.drive.missing_share = share;
    const auto estimate = identify<double>(parameters, half, 20, kAsItIs)->estimate();
    const double at_work = 0.125 / (1 - share);
    EXPECT_LT(std::abs(estimate.mass_kg.fitted - at_work), 1.96 * estimate.mass_kg.fitted_sd);
  }
}

TEST(PointIdentification, SaysTheSameInFloat) {
  const auto in_double = identify<double>(exact(), {}, 20, kAsItIs)->estimate();
  const auto in_float = identify<float>(exact(), {}, 20, kAsItIs)->estimate();
  const auto expect_same = [](const auto& d, const auto& f) {
    EXPECT_EQ(d.limit, f.limit);
    EXPECT_NEAR(static_cast<double>(f.fitted), d.fitted, 0.1 * d.fitted_sd);
    EXPECT_NEAR(static_cast<double>(f.fitted_sd) / d.fitted_sd, 1, 0.1);
  };
  expect_same(in_double.friction_Ns_m, in_float.friction_Ns_m);
  expect_same(in_double.mass_kg, in_float.mass_kg);
}

TEST(PointIdentification, NeedsADriveAndTime) {
  PointIdentification<double> alone(exact());
  for (TimeNs k = 0; k < 600; ++k)
    alone.add_position(k * 16'666'667, ChewingPoint::position_m(static_cast<double>(k) / 60));
  EXPECT_EQ(alone.estimate().mass_kg.limit, ImpedanceLimit::no_drive);
  EXPECT_EQ(alone.estimate().mass_kg.quantity.provenance, Provenance::assumed);
  EXPECT_EQ(alone.estimate().mass_kg.quantity.value, exact().mass_kg.mean);
  EXPECT_EQ(identify<double>(exact(), {}, 5, kAsItIs)->estimate().mass_kg.limit,
            ImpedanceLimit::too_early);
  PointIdentification<double> slow(exact());
  for (TimeNs k = 0; k < 200; ++k) {
    slow.add_drive(k * 100'000'000, 0);
    slow.add_position(k * 100'000'000, ChewingPoint::position_m(static_cast<double>(k) / 10));
  }
  EXPECT_EQ(slow.estimate().mass_kg.limit, ImpedanceLimit::too_slow);
}

TEST(PointIdentification, GapsAndMissingPositionsCostOnlyTheirSurroundings) {
  const auto whole = identify<double>(exact(), {}, 30, kAsItIs);
  int k = 0;
  const auto holed = identify<double>(
      exact(), {}, 30, [&](double t, double&) { return std::fmod(t, 10) > 0.4 && ++k % 7 != 0; });
  expect_truth(holed->estimate(), {});
  EXPECT_LT(holed->estimate().used_s, whole->estimate().used_s - 1);
  EXPECT_GT(holed->estimate().used_s, whole->estimate().used_s - 5);
}

// Food above 6 mm pushes with what no drive holds; what is masked may be anything.
TEST(PointIdentification, LeavesOutWhatIsInContact) {
  ImpedanceParameters parameters = exact();
  parameters.contact_above_m = 0.006;
  std::mt19937_64 random(5);
  const auto found = identify<double>(parameters, {}, 60, [&](double, double& z) {
    if (z > 0.006) z += 0.01 * static_cast<double>(random() % 100) / 100;
    return true;
  });
  EXPECT_GT(found->counts().positions_in_contact, 100U);
  EXPECT_GT(found->estimate().used_s, 5);
  expect_truth(found->estimate(), {});
}

TEST(PointIdentification, FindsTheDelayAndCoulombFriction) {
  ImpedanceParameters parameters = exact();
  parameters.delay = DelayModel::fitted;
  parameters.drive.delay_sd_s = 0.005;
  parameters.coulomb_N.sd = 0.1;
  ChewingPoint chewing;
  chewing.coulomb_N = 0.02;
  auto identification = std::make_unique<PointIdentification<double>>(parameters);
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise;
  for (int k = 0; k < 6000; ++k) {
    const double t = k / 100.0;
    identification->add_drive(nanoseconds(t + 0.004), chewing.force_N(t) + 1e-3 * noise(random));
    identification->add_position(nanoseconds(t),
                                 ChewingPoint::position_m(t) + 1e-5 * noise(random));
  }
  identification->conclude();
  const auto& estimate = identification->estimate();
  EXPECT_EQ(estimate.delay_s.limit, ImpedanceLimit::none) << limit_name(estimate.delay_s.limit);
  EXPECT_NEAR(estimate.delay_s.fitted, 0.004, 4 * estimate.delay_s.fitted_sd);
  EXPECT_LT(estimate.delay_s.fitted_sd, 5e-4);
  EXPECT_EQ(estimate.coulomb_N.limit, ImpedanceLimit::none) << limit_name(estimate.coulomb_N.limit);
  EXPECT_NEAR(estimate.coulomb_N.fitted, 0.02, 4 * estimate.coulomb_N.fitted_sd);
  EXPECT_NEAR(estimate.friction_Ns_m.fitted, 0.05, 4 * estimate.friction_Ns_m.fitted_sd);
}

// A friction that wanders is that of the end, and known less well than one that stays.
TEST(PointIdentification, AWalkWidensTheInterval) {
  ImpedanceParameters walking = exact();
  walking.friction_Ns_m.walk_per_root_s = 0.002;
  const auto still = identify<double>(exact(), {}, 60, kAsItIs)->estimate().friction_Ns_m;
  const auto walked = identify<double>(walking, {}, 60, kAsItIs)->estimate().friction_Ns_m;
  EXPECT_GT(walked.fitted_sd, 2 * still.fitted_sd);
  EXPECT_LT(walked.fitted_sd, 0.002 * std::sqrt(60.0 / 3));
  EXPECT_NEAR(walked.fitted, 0.05, 4 * walked.fitted_sd);
}

TEST(PointIdentification, BadTimesAreCountedAndDoNoHarm) {
  auto identification = std::make_unique<PointIdentification<double>>(exact());
  std::mt19937_64 random(9);
  const TimeNs wild[] = {std::numeric_limits<TimeNs>::min(), -1, 0, 1,
                         std::numeric_limits<TimeNs>::max()};
  for (TimeNs k = 0; k < 5000; ++k) {
    const bool is_wild = random() % 10 == 0;
    const TimeNs t = is_wild ? wild[random() % 5] : k * 10'000'000;
    identification->add_drive(t, static_cast<double>(random() % 100));
    identification->add_position(random() % 10 == 0 ? wild[random() % 5] : t,
                                 static_cast<double>(random() % 100) * 1e-3);
  }
  identification->conclude();
  EXPECT_NE(identification->estimate().mass_kg.limit, ImpedanceLimit::none);
  EXPECT_GT(identification->counts().drive_gaps, 100U);
}

}  // namespace
}  // namespace condyle
