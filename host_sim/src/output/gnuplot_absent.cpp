// SPDX-License-Identifier: Apache-2.0
// Figures where condyle starts no gnuplot: on Windows.
#include "output/deferred_problem.h"
#include "output/gnuplot.h"

namespace condyle::host {

Gnuplot::Gnuplot(std::string directory) : directory_(std::move(directory)) {}

Gnuplot::~Gnuplot() = default;

void Gnuplot::send(const std::string&) {}

void Gnuplot::draw(const std::string&, const std::string&, int, int) {}

std::vector<std::unique_ptr<OutputFile>> Gnuplot::finish() {
  defer_problem(InputError("gnuplot", "condyle draws no figures on Windows",
                           "condyle report RECORDING writes charts as an HTML page; all other "
                           "output was written"));
  return {};
}

}  // namespace condyle::host
