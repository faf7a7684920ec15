// SPDX-License-Identifier: Apache-2.0
// What a user's own project looks like.
#include <condyle/estimator/published/published_cascade.h>
#include <condyle/hal/clock.h>

#include <cstdio>

int main() {
  condyle::PublishedParameters parameters;
  parameters.sample_time_s = 0.02;
  condyle::PublishedCascade<double> cascade(parameters);
  condyle::hal::SteadyClock clock;
  const condyle::TimeNs start_ns = clock.now_ns();
  double position_m = 0;
  for (int i = 0; i < 50; ++i) position_m = cascade.step(0.001 * i).position_m.value;
  std::printf("position %.1f mm\n", position_m * 1e3);
  return position_m > 0.04 && position_m < 0.06 && clock.now_ns() >= start_ns ? 0 : 1;
}
