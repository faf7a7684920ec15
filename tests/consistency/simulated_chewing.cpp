// SPDX-License-Identifier: Apache-2.0
#include "consistency/simulated_chewing.h"

namespace condyle::testing_support {

std::vector<DrivenSample> chew(const DrivenTruth& truth, double rate_Hz, unsigned seed,
                               double duration_s) {
  DrivenChewing chewing(truth, rate_Hz, seed);
  std::vector<DrivenSample> samples;
  for (double t = 0; t < duration_s; t += 1 / rate_Hz) samples.push_back(chewing.next());
  return samples;
}

}  // namespace condyle::testing_support
