// SPDX-License-Identifier: Apache-2.0
// Figures where condyle starts no gnuplot: on Windows.
#include <fmt/format.h>

#include "output/deferred_problem.h"
#include "output/gnuplot.h"

namespace condyle::host {
namespace {

constexpr const char* kProblem = "condyle draws no figures on Windows";
constexpr const char* kInstead = "condyle report RECORDING writes charts as an HTML page";

}  // namespace

std::string why_no_figures() {
  return fmt::format("{}; {}", kProblem, kInstead);
}

Gnuplot::Gnuplot(std::string directory) : directory_(std::move(directory)) {}

Gnuplot::~Gnuplot() = default;

void Gnuplot::send(const std::string&) {}

void Gnuplot::draw(const std::string&, const std::string&, int, int) {}

std::vector<std::unique_ptr<OutputFile>> Gnuplot::finish() {
  defer_problem(
      InputError("gnuplot", kProblem, fmt::format("{}; all other output was written", kInstead)));
  return {};
}

}  // namespace condyle::host
