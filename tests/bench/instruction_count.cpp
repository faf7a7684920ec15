// SPDX-License-Identifier: Apache-2.0
// Steps each filter of filter_cases.h through kSamples samples; run by check_instructions under
// callgrind, which counts inside `one_step` only and writes a file for each case.
#include <valgrind/callgrind.h>

#include "bench/recorded_cases.h"

int main() {
  using namespace condyle::bench;
  constexpr std::size_t kSamples = 1000;  // check_instructions divides by it
  for_each_case([]<class Case>(const std::string& name) {
    const Recording<typename Case::Scalar> recording(kSamples + 1);
    Case filter;
    one_step(filter, recording.positions_m[0], recording.steps_s[0]);
    CALLGRIND_ZERO_STATS;
    for (std::size_t i = 1; i <= kSamples; ++i) {
      one_step(filter, recording.positions_m[i], recording.steps_s[i]);
    }
    CALLGRIND_DUMP_STATS_AT(name.c_str());
  });
  return 0;
}
