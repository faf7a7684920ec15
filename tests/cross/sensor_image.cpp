// SPDX-License-Identifier: Apache-2.0
// The smallest image of a virtual sensor (CONDYLE_SENSOR, see CMakeLists.txt): what it takes of
// flash, RAM and stack. Runs it on samples with every kind of trouble; prints how deep the stack
// was.
#include "condyle/cortex_m/board.h"
#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/estimator/sensors/recommended_sensor.h"
#include "test_host.h"

namespace condyle::cross {
namespace {

constexpr TimeNs kStep_ns = 5'000'000;

// A triangle, with glitches, a pause, missing and repeated positions, and time running back.
Sample sample_at(int i) {
  Sample sample;
  sample.kind = SampleKind::CONDYLE_KIND;
  sample.time_ns = i * kStep_ns;
  sample.time_ns += (i + 23) / 100 * TimeNs{80'000'000};
  if (i % 300 >= 200) sample.time_ns += 500'000'000;
  if (i % 300 == 150) sample.time_ns -= 2 * kStep_ns;
  const int phase = i % 100;
  double position_m = 1e-4 * (phase < 50 ? phase : 100 - phase) + 1e-6 * (i * 37 % 11);
  if (i % 60 == 59 || (i % 300 > 100 && i % 300 < 108)) position_m += 0.02;
  // After a pause, when little is expected, a glitch passes and is found out by the next sample.
  if (i % 100 == 77) position_m += 0.004 * (1 + i / 100 % 5);
  if (i % 300 > 270) position_m = 1e-3;
  sample.position_valid = i % 70 != 69;
  for (double& coordinate : sample.coordinates) coordinate = position_m;
  return sample;
}

}  // namespace

int test_program(int, const char* const*) {
  using Sensor = CONDYLE_SENSOR;
  static Sensor sensor(CONDYLE_PARAMETERS{});
  SampleChecker checker(kStep_ns);
  bool has_value = false;
  for (int i = 0; i < 600; ++i) {
    const Sample sample = sample_at(i);
    const auto estimate = sensor.process(sample, checker.check(sample));
    has_value = has_value || !estimate.events.has(Event::not_started);
  }
  print(cortex_m::stack_used_bytes());
  print("\n");
  return has_value ? 0 : 1;
}

}  // namespace condyle::cross
