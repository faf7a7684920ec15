// SPDX-License-Identifier: Apache-2.0
// The recommended estimator: positions in, motion with standard deviation and provenance out.
#include <condyle/estimator/sensors/recommended_sensor.h>

#include <cmath>
#include <cstdio>

namespace {

constexpr double kRate_Hz = 60, kPi = 3.14159265358979323846;

void print(const char* name, const condyle::Quantity<double>& quantity, const char* unit) {
  if (quantity.provenance == condyle::Provenance::not_computed) return;
  std::printf("  %s %.4g, sd %.2g %s, %s\n", name, quantity.value, quantity.standard_deviation,
              unit, condyle::provenance_name(quantity.provenance));
}

}  // namespace

int main() {
  const condyle::MotionEstimatorParameters parameters;       // the defaults need no tuning
  condyle::RecommendedSensor<double, 1> sensor(parameters);  // along one axis
  condyle::SampleChecker checker(condyle::nanoseconds(1 / kRate_Hz));
  condyle::RecommendedEstimate<double> estimate;
  for (int i = 0; i < 600; ++i) {  // 10 s of chewing, 10 mm up and down
    const double time_s = i / kRate_Hz;
    condyle::Sample sample;
    sample.time_ns = condyle::nanoseconds(time_s);
    sample.kind = condyle::SampleKind::one_axis;
    sample.coordinates[0] = 0.005 * std::cos(2 * kPi * time_s);  // m
    sample.position_valid = i != 500;                            // one sample is missing
    estimate = sensor.process(sample, checker.check(sample));
    if (i != 500 && i != 599) continue;
    std::printf("at %.3f s\n", condyle::seconds(estimate.time_ns));
    print("position", estimate.axes[0].position_m, "m");
    print("velocity", estimate.axes[0].velocity_m_s, "m/s");
    print("force   ", estimate.axes[0].force_N, "N");
  }
  const condyle::Quantity<double>& velocity = estimate.axes[0].velocity_m_s;
  return velocity.provenance == condyle::Provenance::measured ? 0 : 1;
}
