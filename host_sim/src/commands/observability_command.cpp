// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands/commands.h"
#include "hosted/files/input_error.h"
#include "observability/observability.h"
#include "options/command_line.h"

namespace condyle::host {
namespace {

using Point = OperatingPoint<double>;

template <class Matrix>
std::string row(const char* system, const char* form, const Matrix& matrix) {
  const auto result = judge_observability(matrix);
  if (result.rank < 0) {
    throw InputError("observability", "the matrix exceeds the range of numbers",
                     "choose a state closer to that of a jaw");
  }
  return fmt::format("{:<44}{:<11}{} of {}   {:<12.4g}{:<12.4g}{}\n", system, form, result.rank,
                     result.states, result.smallest_singular_value, result.condition_number,
                     result.rank == result.states ? "observable" : "NOT observable");
}

int print_table(const Point& point) {
  std::string text = fmt::format(
      "Observability at p = {:g} m, v = {:g} m/s, kv = {:g} Ns/m, m = {:g} kg, u = {:g} N, u' = "
      "{:g} N/s (a = {:.4g} m/s^2, u'' = 0)\n",
      point.position_m, point.velocity_m_s, point.friction_Ns_m, point.mass_kg, point.force_N,
      point.force_rate_N_s, point.acceleration_m_s2());
  text += "Lie derivatives of orders 0 to n-1; singular values in SI units\n\n";
  text += fmt::format("{:<44}{:<11}{:<9}{:<12}{:<12}\n", "system: state; measured; known", "form",
                      "rank", "smallest", "condition");
  text += fmt::format("{:<44}{:<11}{:<9}{:<12}{:<12}\n", "", "", "", "singular", "number");
  const auto motion = observability_matrix<MotionSystem>(point);
  text += row("stage 1 (30): p, v, F; p; -", "printed", motion);
  text += row("", "corrected", motion);
  text += row("stage 2 (38, 39): p, v, kv; p, v; u", "printed", printed_friction_matrix(point));
  text += row("", "corrected", observability_matrix<FrictionSystem>(point));
  text += row("stage 3 (43): p, v, m; p, v; u, kv", "printed", printed_mass_matrix(point));
  text += row("", "corrected", observability_matrix<MassSystem>(point));
  text += row("full (24): p, v, ks, m; p; u, kv", "printed",
              observability_matrix<PrintedFullSystem>(point));
  text += row("full (24): p, v, kv, m; p; u", "corrected", observability_matrix<FullSystem>(point));
  text += row("drive unknown: p, v, kv, m, u, u'; p; -", "corrected",
              observability_matrix<UnknownDriveSystem>(point));
  text +=
      "\nPrinted: (24) contains a spring ks that is in no equation; (38, 39) u/m for -v/m; (43) "
      "m^4 for m^2; (30) is correct.\n"
      "Stages 2 and 3 count u as known. In the published cascade u is stage 1's own estimate, m0 "
      "times the acceleration\nseen, so their rank is not a property of the subject. The row with "
      "the drive unknown is.\n";
  print_output(text);
  return kExitOk;
}

}  // namespace

Command add_observability(CommandLine app) {
  auto point = std::make_shared<Point>();
  const CommandLine command = app.add_command(
      "observability", "Print the observability of the paper's systems, as printed and corrected",
      "Simulate");
  command.add_example("condyle observability", "Print the table at the default state.");
  command.add_example("condyle observability --velocity-m-s 0 --force-N 1",
                      "Print it at rest: friction is then unobservable.");
  const auto add = [command](const char* name, double& value, const char* meaning, Range range) {
    command.add_option(name, value, meaning).number_in(range).show_default();
  };
  add("--position-m", point->position_m, "Position p", {-1, 1});
  add("--velocity-m-s", point->velocity_m_s, "Velocity v", {-10, 10});
  add("--friction-Ns-m", point->friction_Ns_m, "Friction kv", {0, 1e4});
  add("--mass-kg", point->mass_kg, "Mass m", {1e-6, 100});
  add("--force-N", point->force_N, "Drive u; in stage 1 the net force", {-1e4, 1e4});
  add("--force-rate-N-s", point->force_rate_N_s, "Rate of change of the drive u'", {-1e6, 1e6});
  return [point] { return print_table(*point); };
}

}  // namespace condyle::host
