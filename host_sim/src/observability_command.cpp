// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <memory>

#include "commands.h"
#include "condyle/estimator/observability.h"
#include "input_error.h"

namespace condyle::host {
namespace {

using Point = OperatingPoint<double>;

template <class Matrix>
void print_row(const char* system, const char* form, const Matrix& matrix) {
  const auto result = judge_observability(matrix);
  fmt::print("{:<44}{:<11}{} of {}   {:<12.4g}{:<12.4g}{}\n", system, form, result.rank,
             result.states, result.smallest_singular_value, result.condition_number,
             result.rank == result.states ? "observable" : "NOT observable");
}

int print_table(const Point& point) {
  if (!(point.mass_kg > 0)) {
    throw InputError("--mass-kg", fmt::format("{} kg is no mass", point.mass_kg),
                     "give a positive number");
  }
  fmt::print(
      "Observability at p = {:g} m, v = {:g} m/s, kv = {:g} Ns/m, m = {:g} kg, u = {:g} N, u' = "
      "{:g} N/s (a = {:.4g} m/s^2, u'' = 0)\n",
      point.position_m, point.velocity_m_s, point.friction_Ns_m, point.mass_kg, point.force_N,
      point.force_rate_N_s, point.acceleration_m_s2());
  fmt::print("Lie derivatives of orders 0 to n-1; singular values in SI units\n\n");
  fmt::print("{:<44}{:<11}{:<9}{:<12}{:<12}\n", "system: state; measured; known", "form", "rank",
             "smallest", "condition");
  fmt::print("{:<44}{:<11}{:<9}{:<12}{:<12}\n", "", "", "", "singular", "number");
  const auto motion = observability_matrix<MotionSystem>(point);
  print_row("stage 1 (30): p, v, F; p; -", "printed", motion);
  print_row("", "corrected", motion);
  print_row("stage 2 (38, 39): p, v, kv; p, v; u", "printed", printed_friction_matrix(point));
  print_row("", "corrected", observability_matrix<FrictionSystem>(point));
  print_row("stage 3 (43): p, v, m; p, v; u, kv", "printed", printed_mass_matrix(point));
  print_row("", "corrected", observability_matrix<MassSystem>(point));
  print_row("full (24): p, v, ks, m; p; u, kv", "printed",
            observability_matrix<PrintedFullSystem>(point));
  print_row("full (24): p, v, kv, m; p; u", "corrected", observability_matrix<FullSystem>(point));
  print_row("drive unknown: p, v, kv, m, u, u'; p; -", "corrected",
            observability_matrix<UnknownDriveSystem>(point));
  fmt::print(
      "\nPrinted: (24) holds a spring ks that enters no equation; (38, 39) u/m for -v/m; (43) m^4 "
      "for m^2; (30) as it should be.\n"
      "Stages 2 and 3 count u as known. In the published cascade u is stage 1's own estimate, m0 "
      "times the acceleration\nseen, so their rank says nothing about the subject: the row with "
      "the drive unknown does.\n");
  return kExitOk;
}

}  // namespace

Command add_observability(CLI::App& app) {
  auto point = std::make_shared<Point>();
  CLI::App* const command = app.add_subcommand(
      "observability", "Print the observability of the paper's systems, as printed and corrected");
  const auto add = [command](const char* name, double& value, const char* meaning) {
    command->add_option(name, value, meaning)->check(CLI::Range(-1e9, 1e9))->capture_default_str();
  };
  add("--position-m", point->position_m, "Position p");
  add("--velocity-m-s", point->velocity_m_s, "Velocity v");
  add("--friction-Ns-m", point->friction_Ns_m, "Friction kv");
  add("--mass-kg", point->mass_kg, "Mass m");
  add("--force-N", point->force_N, "Drive u; in stage 1 the net force");
  add("--force-rate-N-s", point->force_rate_N_s, "Rate of change of the drive u'");
  return [point] { return print_table(*point); };
}

}  // namespace condyle::host
