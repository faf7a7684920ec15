// SPDX-License-Identifier: Apache-2.0
// A long motion at 200 Hz, made inside the program, through both estimators in float: hashes of all
// estimates so far (FNV-1a, 64 bits; G. Fowler, L. Noll, P. Vo), which are the same on every
// machine. usage: day_of_estimates HASHES SAMPLES
//   HASHES lines, one after each SAMPLES more samples; 24 720000: a day, hourly.
#include <cstdint>

#include "condyle/estimator/math/elementary.h"
#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/estimator/sensors/recommended_sensor.h"
#include "estimate_writer.h"
#include "test_host.h"

namespace condyle::cross {
namespace {

class Hash {
 public:
  void put(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100000001B3; }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325;
};

// Chewing at 1.1 Hz between 0 and -16 mm with noise; now and then a glitch, a dropout or a pause.
class Motion {
 public:
  Sample next() {
    constexpr TimeNs kStep_ns = 5'000'000;
    constexpr double kTurn = 6.283185307179586;
    Sample sample;
    time_ns_ += index_ % 100'003 == 0 ? 100 * kStep_ns : kStep_ns;
    sample.time_ns = time_ns_;
    sample.sequence = index_;
    // 11 turns in 2000 samples, as an integer: a phase does not wear off.
    const double turn = static_cast<double>(index_ * 11 % 2000) / 2000;
    double position_m = -0.008 * (1 - elementary::cos(kTurn * turn));
    for (int i = 0; i < 4; ++i) position_m += 1e-4 * random();
    if (index_ % 9973 == 0) position_m += 0.01;
    sample.coordinates[0] = position_m;
    sample.position_valid = index_ % 4999 != 0;
    ++index_;
    return sample;
  }

 private:
  // From -0.5 to 0.5; D. E. Knuth's linear congruence MMIX.
  double random() {
    state_ = state_ * 6364136223846793005 + 1442695040888963407;
    return static_cast<double>(state_ >> 40U) / 0x1p24 - 0.5;
  }
  std::uint64_t index_ = 1, state_ = 1;
  TimeNs time_ns_ = 0;
};

std::uint64_t number_of(const char* text) {
  std::uint64_t number = 0;
  for (; *text >= '0' && *text <= '9'; ++text) {
    number = number * 10 + static_cast<std::uint64_t>(*text - '0');
  }
  return number;
}

PublishedParameters parameters() {
  PublishedParameters result;
  result.sample_time_s = 0.005;
  return result;
}

template <class Sensor>
void print_hashes(Sensor& sensor, std::uint64_t hashes, std::uint64_t samples) {
  static Motion motion;
  SampleChecker checker(5'000'000);
  Hash hash;
  EstimateWriter<Hash> write{hash};
  for (std::uint64_t line = 1; line <= hashes; ++line) {
    for (std::uint64_t i = 0; i < samples; ++i) {
      const Sample sample = motion.next();
      write(sensor.process(sample, checker.check(sample)));
    }
    print(line * samples);
    print(" samples: ");
    print(hash.value());
    print("\n");
  }
}

}  // namespace

int test_program(int count, const char* const* arguments) {
  if (count != 3) {
    print("usage: day_of_estimates published|recommended HASHES SAMPLES\n");
    return 2;
  }
  const std::uint64_t hashes = number_of(arguments[1]), samples = number_of(arguments[2]);
  if (arguments[0][0] == 'p') {
    static PublishedSensor<float> sensor(parameters());
    print_hashes(sensor, hashes, samples);
  } else {
    static RecommendedSensor<float, 1, 0> sensor{MotionEstimatorParameters()};
    print_hashes(sensor, hashes, samples);
  }
  return 0;
}

}  // namespace condyle::cross
