// SPDX-License-Identifier: Apache-2.0
// Figures of the textbook behaviour of the simulated friction laws.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "commands/commands.h"
#include "options/command_line.h"
#include "output/gnuplot.h"
#include "output/output_file.h"
#include "simulation/friction.h"
#include "simulation/integrator.h"

namespace condyle::host {
namespace {

// Pairs of numbers as a gnuplot data block.
class Block {
 public:
  explicit Block(const char* name) : text_(fmt::format("${} << EOD\n", name)) {}
  void add(double x, double y) { text_ += fmt::format("{:.9g} {:.9g}\n", x, y); }
  std::string text() const { return text_ + "EOD\n"; }

 private:
  std::string text_;
};

FrictionLaw law_of(FrictionModel model) {
  FrictionLaw law;
  law.model = model;
  return law;
}

// Steady friction against velocity.
std::string stribeck_curve() {
  std::string text;
  const std::pair<const char*, FrictionModel> curves[] = {{"viscous", FrictionModel::viscous},
                                                          {"coulomb", FrictionModel::coulomb},
                                                          {"stribeck", FrictionModel::stribeck},
                                                          {"lugre", FrictionModel::lugre}};
  for (const auto& [name, model] : curves) {
    Block block(name);
    const FrictionLaw law = law_of(model);
    for (int i = 1; i <= 1000; ++i) block.add(i * 1e-2, steady_friction_N(law, i * 1e-5));
    text += block.text();
  }
  return text;
}

// A mass of 1 kg drawn over a spring of 2 N/m by an end that moves at 0.1 m/s.
std::string stick_slip() {
  constexpr double mass_kg = 1, spring_N_m = 2, pull_m_s = 0.1, step_s = 5e-5;
  const FrictionLaw law = law_of(FrictionModel::lugre);
  std::array<double, 3> x{};  // position, velocity, bristle deflection
  Block mass("mass"), end("end");
  for (int i = 0; i < 500'000; ++i) {
    const double time_s = i * step_s;
    if (i % 500 == 0) {
      mass.add(time_s, x[0]);
      end.add(time_s, pull_m_s * time_s);
    }
    runge_kutta_4_step(x, time_s, step_s, [&](double t, const auto& s, auto& rate) {
      rate[0] = s[1];
      rate[1] = (spring_N_m * (pull_m_s * t - s[0]) - friction_force_N(law, s[1], s[2])) / mass_kg;
      rate[2] = bristle_rate_m_s(law, s[1], s[2]);
    });
  }
  return mass.text() + end.text();
}

// Friction while the velocity swings between 0 and 2.5 mm/s, slowly and fast.
std::string hysteresis() {
  constexpr double step_s = 2e-5, two_pi = 6.283185307179586;
  const FrictionLaw law = law_of(FrictionModel::lugre);
  std::string text;
  for (const auto& [name, rate_rad_s] : {std::pair{"slow", 1.0}, std::pair{"fast", 25.0}}) {
    Block block(name);
    std::array<double, 1> z{};
    const auto velocity = [w = rate_rad_s](double t) { return 1.25e-3 * (1 - std::cos(w * t)); };
    const int steps = static_cast<int>(2 * two_pi / rate_rad_s / step_s);
    for (int i = 0; i < steps; ++i) {
      const double t = i * step_s;
      if (i > steps / 2 && i % (steps / 1000) == 0) {
        block.add(velocity(t) * 1e3, friction_force_N(law, velocity(t), z[0]));
      }
      runge_kutta_4_step(z, t, step_s, [&](double at, const auto& s, auto& dz) {
        dz[0] = bristle_rate_m_s(law, velocity(at), s[0]);
      });
    }
    text += block.text();
  }
  return text;
}

// A mass of 0.25 kg under a force that grows steadily: the largest force that its bristles resist.
std::string break_away() {
  constexpr double mass_kg = 0.25, step_s = 2e-5;
  const FrictionLaw law = law_of(FrictionModel::lugre);
  Block block("breakaway");
  for (const double growth_N_s : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
    std::array<double, 3> x{};
    double time_s = 0;
    double spring_N = 0;  // largest bristle force
    for (; x[1] < 10 * law.stribeck_velocity_m_s && time_s < 10; time_s += step_s) {
      runge_kutta_4_step(x, time_s, step_s, [&](double t, const auto& s, auto& rate) {
        rate[0] = s[1];
        rate[1] = (growth_N_s * t - friction_force_N(law, s[1], s[2])) / mass_kg;
        rate[2] = bristle_rate_m_s(law, s[1], s[2]);
      });
      spring_N = std::max(spring_N, law.bristle_stiffness_N_m * x[2]);
    }
    block.add(growth_N_s, spring_N);
  }
  return block.text();
}

int draw(const std::string& directory) {
  const OutputFolder folder(directory);
  Gnuplot gnuplot(directory);
  gnuplot.send("set key right top\n");
  const auto figure = [&](const char* name, const std::string& data, const char* title,
                          const char* set, const char* plot) {
    gnuplot.send(data + title_command(title) + set);
    gnuplot.draw(name, plot, 720, 480);
  };
  figure("stribeck_curve", stribeck_curve(), "Steady friction",
         "set xlabel 'velocity (mm/s)'\nset ylabel 'friction (N)'\n",
         "plot $viscous with lines lw 2 title 'viscous', $coulomb with lines lw 2 title 'Coulomb, "
         "smoothed', "
         "$stribeck with lines lw 3 title 'Stribeck', $lugre with lines lw 2 dt 2 title 'LuGre'");
  figure("stick_slip", stick_slip(), "Stick-slip: 1 kg on 2 N/m drawn at 0.1 m/s, LuGre",
         "set xlabel 'time (s)'\n"
         "set ylabel 'position (m)'\nset key left top\n",
         "plot $end with lines dt 2 title 'drawn end', $mass with lines lw 2 title 'mass'");
  figure("hysteresis", hysteresis(), "Hysteresis: friction lags the velocity, LuGre",
         "set xlabel 'velocity (mm/s)'\n"
         "set ylabel 'friction (N)'\nset key right top\n",
         "plot $slow with lines lw 2 title '1 rad/s', $fast with lines lw 2 title '25 rad/s'");
  figure("break_away", break_away(),
         "Break-away force falls with the rate of the force, LuGre, 0.25 kg",
         "set logscale x\n"
         "set xlabel 'growth of the force (N/s)'\nset ylabel 'greatest force held (N)'\n",
         "plot $breakaway with linespoints pt 7 lw 2 notitle");
  std::string text;
  text += commit_all(gnuplot.finish());
  print_output(text);
  return kExitOk;
}

}  // namespace

Command add_friction(CommandLine app) {
  auto directory = std::make_shared<std::string>();
  const CommandLine command =
      app.add_command("friction", "Draw the friction laws of the simulator", "Simulate");
  command.add_example("condyle friction --figures figures", "Draw them into the folder figures.");
  command.add_example("condyle friction --figures ~/friction", "Draw them into another folder.");
  command.group("Output")
      .add_option("--figures=FOLDER", *directory, "Folder for figures (SVG and PNG)")
      .required();
  return [directory] { return draw(*directory); };
}

}  // namespace condyle::host
