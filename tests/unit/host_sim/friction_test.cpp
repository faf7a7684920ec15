// SPDX-License-Identifier: Apache-2.0
// The friction models against the behaviour their literature describes, and the integrator.
#include "simulation/friction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "simulation/integrator.h"

namespace condyle::host {
namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr FrictionModel kModels[] = {FrictionModel::viscous, FrictionModel::coulomb,
                                     FrictionModel::stribeck, FrictionModel::lugre};

FrictionLaw demonstration(FrictionModel model) {
  return {.model = model};
}

// Moves a state of `n` numbers to `end_s` in steps of about `step_s`.
template <std::size_t n, class Derivative>
std::array<double, n> integrate(std::array<double, n> x, double end_s, double step_s,
                                const Derivative& f) {
  const auto steps = static_cast<int>(std::lround(end_s / step_s));
  for (int i = 0; i < steps; ++i) runge_kutta_4_step(x, i * end_s / steps, end_s / steps, f);
  return x;
}

// A mass under a drive u(t, x, v) and friction: state x (m), v (m/s), z (m).
using State = std::array<double, 3>;
template <class Drive>
auto moving_mass(const FrictionLaw& parameters, double mass_kg, const Drive& drive) {
  return [=](double time_s, const State& s, State& rate) {
    const double force_N = drive(time_s, s[0], s[1]) - friction_force_N(parameters, s[1], s[2]);
    rate = {s[1], force_N / mass_kg, bristle_rate_m_s(parameters, s[1], s[2])};
  };
}

TEST(Integrator, IsOfOrderFour) {
  // (x0, x1)' = (x1, -x0) has the solution (cos t, -sin t); the third
  // number, x2' = 3 t^2 x2 / (1 + t^3), depends on the time and becomes 1 + t^3.
  const auto f = [](double t, const State& x, State& rate) {
    rate = {x[1], -x[0], 3 * t * t * x[2] / (1 + t * t * t)};
  };
  const auto error = [&](double step_s) {
    const State x = integrate(State{1, 0, 1}, 2, step_s, f);
    return std::array{std::hypot(x[0] - std::cos(2.0), x[1] + std::sin(2.0)), std::abs(x[2] - 9)};
  };
  const auto coarse = error(0.02), fine = error(0.01);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(std::log2(coarse[i] / fine[i]), 4, 0.1);
    EXPECT_LT(fine[i], 1e-7);
  }
}

TEST(Friction, ForcesAreTheirEquations) {
  FrictionLaw p = demonstration(FrictionModel::viscous);
  EXPECT_DOUBLE_EQ(friction_force_N(p, -0.1, 0), -0.04);
  EXPECT_DOUBLE_EQ(friction_force_N(p, -0.1, 0, 22), -0.88);
  p.model = FrictionModel::coulomb;
  EXPECT_DOUBLE_EQ(friction_force_N(p, 0.1, 0), 1.04);
  EXPECT_DOUBLE_EQ(friction_force_N(p, 1e-4, 0), std::tanh(1.0) + 4e-5);
  p.model = FrictionModel::stribeck;
  EXPECT_DOUBLE_EQ(friction_force_N(p, 1e-3, 0),
                   (1 + 0.5 * std::exp(-1.0)) * std::tanh(10.0) + 4e-4);
  p.model = FrictionModel::lugre;
  EXPECT_DOUBLE_EQ(bristle_rate_m_s(p, 1e-3, 5e-6), 1e-3 - 0.5e-3 / (1 + 0.5 * std::exp(-1.0)));
  EXPECT_DOUBLE_EQ(friction_force_N(p, 1e-3, 5e-6),
                   0.5 + 316 * bristle_rate_m_s(p, 1e-3, 5e-6) + 4e-4);
}

TEST(Friction, IsOddInVelocityAndDeflectionAndLinearInScale) {
  for (const FrictionModel model : kModels) {
    const FrictionLaw p = demonstration(model);
    for (const double v : {0.0, 1e-6, 3e-4, 2e-3, 0.1}) {
      for (const double z : {0.0, 4e-6, -1e-5}) {
        const double force_N = friction_force_N(p, v, z);
        EXPECT_EQ(friction_force_N(p, -v, -z), -force_N);
        EXPECT_DOUBLE_EQ(friction_force_N(p, v, z, 3), 3 * force_N);
        EXPECT_DOUBLE_EQ(friction_slope_Ns_m(p, -v, -z, 3), 3 * friction_slope_Ns_m(p, v, z));
        EXPECT_EQ(friction_force_N(p, v, z, 0), 0);
      }
    }
  }
}

TEST(Friction, SlopesAreTheDerivatives) {
  for (const FrictionModel model : kModels) {
    const FrictionLaw p = demonstration(model);
    for (const double v : {-0.1, -1e-3, -2e-5, 1e-6, 5e-5, 7e-4, 3e-3, 0.05}) {
      for (const double z : {0.0, 6e-6, -9e-6}) {
        const double h = 1e-4 * std::abs(v);
        const double expected =
            (friction_force_N(p, v + h, z, 2) - friction_force_N(p, v - h, z, 2)) / (2 * h);
        EXPECT_NEAR(friction_slope_Ns_m(p, v, z, 2), expected, 1e-5 * std::abs(expected) + 1e-7);
        const double steady =
            (steady_friction_N(p, v + h, 2) - steady_friction_N(p, v - h, 2)) / (2 * h);
        EXPECT_NEAR(steady_friction_slope_Ns_m(p, v, 2), steady, 1e-5 * std::abs(steady) + 1e-7);
      }
    }
  }
  const FrictionLaw p = demonstration(FrictionModel::lugre);
  EXPECT_DOUBLE_EQ(friction_slope_Ns_m(p, 0, 0), 316.4) << "stuck: bristle damping";
  EXPECT_NEAR(friction_slope_Ns_m(p, 0.1, steady_deflection_m(p, 0.1)), 0.4, 1e-9) << "sliding";
}

TEST(Friction, StribeckCurveDipsBetweenBreakAwayAndViscousBranch) {
  for (const FrictionModel model : {FrictionModel::stribeck, FrictionModel::lugre}) {
    const FrictionLaw p = demonstration(model);
    const double slow = steady_friction_N(p, 3e-4), dip = steady_friction_N(p, 4e-3);
    const double fast = steady_friction_N(p, 1);
    EXPECT_GT(slow, 1.44);
    EXPECT_NEAR(dip, 1.0016, 1e-4);
    EXPECT_NEAR(fast, 1.4, 1e-9);
    EXPECT_LT(steady_friction_slope_Ns_m(p, 1e-3), -300) << "falls: the cause of stick-slip";
    EXPECT_NEAR(steady_friction_slope_Ns_m(p, 0.1), 0.4, 1e-9);
  }
}

TEST(Friction, LuGreSettlesOnTheStribeckCurve) {
  const FrictionLaw p = demonstration(FrictionModel::lugre);
  for (const double v : {-0.05, -2e-3, -4e-4, 4e-4, 1e-3, 2e-3, 0.01, 0.1}) {
    const auto bristles = [&](double, const std::array<double, 1>& z, std::array<double, 1>& rate) {
      rate[0] = bristle_rate_m_s(p, v, z[0]);
    };
    // 40 relaxation times g/(s0 |v|).
    const double end_s = 40 * 1.5 / (1e5 * std::abs(v));
    const auto z = integrate(std::array{0.0}, end_s, end_s / 2000, bristles);
    EXPECT_NEAR(z[0], steady_deflection_m(p, v), 1e-9 * std::abs(z[0]));
    EXPECT_NEAR(friction_force_N(p, v, z[0]), steady_friction_N(p, v), 1e-9);
    FrictionLaw stribeck = p;
    stribeck.model = FrictionModel::stribeck;
    stribeck.smoothing_velocity_m_s = 1e-6;
    EXPECT_NEAR(steady_friction_N(p, v), friction_force_N(stribeck, v, 0), 1e-12);
  }
}

TEST(Friction, LuGreIsASpringBeforeItSlides) {
  const FrictionLaw p = demonstration(FrictionModel::lugre);
  // 1 kg under a force of 1 mN, a thousandth of the sliding force: rests where s0 x carries it.
  const auto pushed = moving_mass(p, 1, [](double, double, double) { return 1e-3; });
  const State x = integrate(State{0, 0, 0}, 1, 1e-4, pushed);
  EXPECT_NEAR(x[0], 1e-3 / 1e5, 1e-3 * 1e-8);
  EXPECT_NEAR(x[1], 0, 1e-15);

  // Undamped, it rings at sqrt(s0/m): back at its start after one period.
  FrictionLaw undamped = p;
  undamped.bristle_damping_Ns_m = 0;
  undamped.viscous_Ns_m = 0;
  const auto free = moving_mass(undamped, 1, [](double, double, double) { return 0.0; });
  const double period_s = kTwoPi / std::sqrt(1e5);
  const State ring = integrate(State{1e-10, 0, 1e-10}, period_s, period_s / 1000, free);
  EXPECT_NEAR(ring[0], 1e-10, 1e-14);
}

// Largest friction, less its viscous part, of 1 kg at rest under a force that grows at `rate_N_s`.
double break_away_N(const FrictionLaw& p, double rate_N_s) {
  const auto ramp = moving_mass(p, 1, [=](double t, double, double) { return rate_N_s * t; });
  State x = {0, 0, 0};
  double largest_N = 0;
  constexpr double step_s = 5e-5;
  for (int i = 0; x[0] < 1e-3; ++i) {
    runge_kutta_4_step(x, i * step_s, step_s, ramp);
    const double dry_N = friction_force_N(p, x[1], x[2]) - p.viscous_Ns_m * x[1];
    largest_N = std::max(largest_N, dry_N);
  }
  return largest_N;
}

TEST(Friction, BreakAwayForceFallsWithTheForceRate) {
  // As in figure 5 of Canudas de Wit et al., for 1 to 50 N/s.
  const FrictionLaw p = demonstration(FrictionModel::lugre);
  EXPECT_NEAR(break_away_N(p, 0.1), 1.5, 0.03);
  double last_N = 1.5;
  for (const double rate_N_s : {0.2, 1.0, 5.0, 10.0, 20.0, 50.0}) {
    const double now_N = break_away_N(p, rate_N_s);
    EXPECT_LT(now_N, last_N) << rate_N_s;
    last_N = now_N;
  }
  EXPECT_NEAR(break_away_N(p, 10), 1.22, 0.01);
  EXPECT_NEAR(last_N, 1.0, 0.02);
}

// A mass of 1 kg pulled over a spring of 2 N/m whose end moves at `speed_m_s`, from rest: the
// paper's stick-slip experiment. Returns when it broke away.
struct Pull {
  std::vector<double> slips_s;
  double slowest_m_s = 1e9, fastest_m_s = 0;  // in the second half
};

Pull pull(const FrictionLaw& p, double speed_m_s, double duration_s, double step_s) {
  const auto pulled =
      moving_mass(p, 1, [=](double t, double x, double) { return 2 * (speed_m_s * t - x); });
  Pull result;
  State x = {0, 0, 0};
  bool was_stuck = false;
  const auto steps = static_cast<int>(duration_s / step_s);
  for (int i = 0; i < steps; ++i) {
    runge_kutta_4_step(x, i * step_s, step_s, pulled);
    const bool stuck = std::abs(x[1]) < 0.01 * speed_m_s;
    if (was_stuck && !stuck && i * step_s > 0.1) result.slips_s.push_back(i * step_s);
    was_stuck = stuck;
    if (2 * i < steps) continue;
    result.slowest_m_s = std::min(result.slowest_m_s, x[1]);
    result.fastest_m_s = std::max(result.fastest_m_s, x[1]);
  }
  return result;
}

TEST(Friction, SlowPullSticksAndSlipsPeriodically) {
  const Pull slow = pull(demonstration(FrictionModel::lugre), 0.1, 28, 4e-5);
  ASSERT_EQ(slow.slips_s.size(), 4U);
  const double period_s = slow.slips_s[3] - slow.slips_s[2];
  EXPECT_NEAR(slow.slips_s[2] - slow.slips_s[1], period_s, 1e-3);
  EXPECT_NEAR(period_s, 6.36, 0.05);
  // The spring's force grows to near the break-away force before the first slip.
  EXPECT_NEAR(2 * 0.1 * slow.slips_s[0], 1.49, 0.02);
  EXPECT_NEAR(slow.slowest_m_s, 0, 1e-3);
  EXPECT_GT(slow.fastest_m_s, 0.3);
}

TEST(Friction, FastPullOrNoDipSlidesSteadily) {
  const Pull fast = pull(demonstration(FrictionModel::lugre), 0.5, 40, 2.5e-5);
  EXPECT_EQ(fast.slips_s.size(), 1U) << "the start";
  EXPECT_GT(fast.slowest_m_s, 0.48);
  EXPECT_LT(fast.fastest_m_s, 0.52);

  FrictionLaw flat = demonstration(FrictionModel::lugre);
  flat.static_N = flat.coulomb_N;
  const Pull no_dip = pull(flat, 0.1, 40, 4e-5);
  EXPECT_EQ(no_dip.slips_s.size(), 1U) << "the start";
  EXPECT_GT(no_dip.slowest_m_s, 0.09);
  EXPECT_LT(no_dip.fastest_m_s, 0.11);
}

// Area of the loop of friction over velocity (N m/s) in the third period, for a velocity that
// swings about 1.5 mm/s without reversing.
double loop_area(const FrictionLaw& p, double frequency_rad_s) {
  const auto velocity_m_s = [=](double t) {
    return 1.5e-3 + 1.2e-3 * std::sin(frequency_rad_s * t);
  };
  const auto bristles = [&](double t, const std::array<double, 1>& z, std::array<double, 1>& rate) {
    rate[0] = bristle_rate_m_s(p, velocity_m_s(t), z[0]);
  };
  constexpr int steps = 40'000;
  const double step_s = kTwoPi / frequency_rad_s / steps;
  std::array<double, 1> z = {steady_deflection_m(p, velocity_m_s(0))};
  double area = 0;
  for (int i = 0; i < 3 * steps; ++i) {
    const double t = i * step_s;
    const double acceleration_m_s2 = 1.2e-3 * frequency_rad_s * std::cos(frequency_rad_s * t);
    if (i >= 2 * steps) {
      area += friction_force_N(p, velocity_m_s(t), z[0]) * acceleration_m_s2 * step_s;
    }
    runge_kutta_4_step(z, t, step_s, bristles);
  }
  return area;
}

TEST(Friction, LagsBehindVelocityTheMoreTheFasterItChanges) {
  // Figure 3 of Canudas de Wit et al.: 1, 10 and 25 rad/s. Positive: more while speeding up.
  const FrictionLaw p = demonstration(FrictionModel::lugre);
  const double slow = loop_area(p, 1), middle = loop_area(p, 10), fast = loop_area(p, 25);
  EXPECT_GT(slow, 0);
  EXPECT_GT(middle, 5 * slow);
  EXPECT_GT(fast, 1.5 * middle);
  EXPECT_NEAR(loop_area(demonstration(FrictionModel::stribeck), 10), 0, 1e-3 * middle)
      << "without memory, no loop";
}

TEST(Friction, DissipatesOverEveryCycleAndBalancesEnergy) {
  for (const FrictionModel model : kModels) {
    const FrictionLaw p = demonstration(model);
    for (const double amplitude_m_s : {1e-4, 2e-3, 0.1}) {
      constexpr double frequency_Hz = 1.3;
      const auto velocity_m_s = [=](double t) {
        return amplitude_m_s * std::sin(kTwoPi * frequency_Hz * t);
      };
      // z, and the energies taken from the motion and turned into heat.
      const auto rates = [&](double t, const State& s, State& rate) {
        const double v = velocity_m_s(t);
        rate = {bristle_rate_m_s(p, v, s[0]), friction_force_N(p, v, s[0], 1.7) * v,
                dissipated_power_W(p, v, s[0], 1.7)};
      };
      constexpr int steps = 40'000;
      constexpr double step_s = 1 / frequency_Hz / steps;
      State s = {0, 0, 0};
      double heat_J = 0;
      for (int i = 0; i < 5 * steps; ++i) {
        runge_kutta_4_step(s, i * step_s, step_s, rates);
        if ((i + 1) % steps == 0) {
          EXPECT_GT(s[2], heat_J) << "cycle " << i / steps;
          heat_J = s[2];
        }
      }
      EXPECT_GT(heat_J, 0);
      const double stored_J = bristle_energy_J(p, s[0], 1.7);
      EXPECT_NEAR(s[1], s[2] + stored_J, 1e-9 * s[1]);
      if (model != FrictionModel::lugre) {
        EXPECT_EQ(s[1], s[2]);
        for (const double v : {-0.1, -1e-5, 0.0, 1e-5, 0.1}) {
          EXPECT_GE(dissipated_power_W(p, v, 0), 0);
        }
      }
    }
  }
}

TEST(Friction, HalvingTheStepChangesNothingWhereMotionIsSmooth) {
  for (const FrictionModel model : kModels) {
    FrictionLaw p = demonstration(model);
    p.smoothing_velocity_m_s = 1e-2;
    p.stribeck_velocity_m_s = 2e-2;
    // A quarter kilogram that slides at 0.1 to 0.2 m/s under a drive of 1.3 Hz.
    const auto driven = moving_mass(p, 0.25, [](double t, double, double v) {
      return 1.2 + 0.1 * std::sin(kTwoPi * 1.3 * t) + 5 * (0.15 - v);
    });
    const State start = {0, 0.15, steady_deflection_m(p, 0.15)};
    const State coarse = integrate(start, 2, 5e-5, driven);
    const State fine = integrate(start, 2, 2.5e-5, driven);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(coarse[i], fine[i], 1e-6 * std::abs(fine[i])) << static_cast<int>(model);
    }
    EXPECT_GT(fine[0], 0.1);
  }
  // Through reversals, with the smoothed sign.
  FrictionLaw p = demonstration(FrictionModel::stribeck);
  p.smoothing_velocity_m_s = 1e-2;
  p.stribeck_velocity_m_s = 2e-2;
  const auto driven = moving_mass(
      p, 0.25, [](double t, double x, double) { return 3 * std::sin(kTwoPi * 1.3 * t) - 5 * x; });
  const State coarse = integrate(State{0, 0, 0}, 2, 1e-4, driven);
  const State fine = integrate(State{0, 0, 0}, 2, 5e-5, driven);
  EXPECT_NEAR(coarse[0], fine[0], 1e-6 * std::abs(fine[0]));
  EXPECT_NEAR(coarse[1], fine[1], 1e-6 * std::abs(fine[1]));
}

TEST(Friction, SchedulesHaveTheirShapes) {
  using Shape = FrictionSchedule::Shape;
  EXPECT_EQ(FrictionSchedule{}.factor_at(5), 1);
  const FrictionSchedule constant = {.shape = Shape::constant, .factor = 22};
  EXPECT_EQ(constant.factor_at(-1), 22);
  EXPECT_EQ(constant.factor_at(1e6), 22);
  const FrictionSchedule step = {.shape = Shape::step, .start_s = 10, .factor = 4};
  EXPECT_EQ(step.factor_at(std::nextafter(10.0, 0.0)), 1);
  EXPECT_EQ(step.factor_at(10), 4);
  EXPECT_EQ(step.factor_at(20), 4);
  const FrictionSchedule ramp = {.shape = Shape::ramp, .start_s = 10, .end_s = 20, .factor = 4};
  EXPECT_EQ(ramp.factor_at(0), 1);
  EXPECT_EQ(ramp.factor_at(10), 1);
  EXPECT_DOUBLE_EQ(ramp.factor_at(12), 1.6);
  EXPECT_DOUBLE_EQ(ramp.factor_at(15), 2.5);
  EXPECT_EQ(ramp.factor_at(20), 4);
  EXPECT_EQ(ramp.factor_at(30), 4);
  const FrictionSchedule instant = {.shape = Shape::ramp, .start_s = 10, .end_s = 10, .factor = 4};
  EXPECT_EQ(instant.factor_at(10), 1);
  EXPECT_EQ(instant.factor_at(10.1), 4);
}

}  // namespace
}  // namespace condyle::host
