// SPDX-License-Identifier: Apache-2.0
#include "output/deferred_problem.h"

namespace condyle::host {
namespace {

std::vector<std::string> kept;

}  // namespace

void defer_problem(const InputError& problem) {
  kept.emplace_back(problem.what());
}

const std::vector<std::string>& deferred_problems() {
  return kept;
}

}  // namespace condyle::host
