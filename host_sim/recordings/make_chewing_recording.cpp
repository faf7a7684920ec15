// SPDX-License-Identifier: Apache-2.0
// Makes the recording shipped in this folder, and longer ones for benchmarks:
//   make_chewing_recording SECONDS RATE_HZ > RECORDING.csv
// Vertical position of a chewing jaw: cycles that open and close smoothly, about 1.3 a second and
// 15 mm deep, each of its own length and depth, seen with 0.1 mm of white noise.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace {

// SplitMix64 (Steele, Lea, Flood 2014): the same numbers everywhere.
class Generator {
 public:
  explicit Generator(std::uint64_t seed) : state_(seed) {}
  double uniform() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    z ^= z >> 31U;
    return static_cast<double>(z >> 11U) * 0x1p-53;
  }
  // Sum of twelve uniform numbers: close to normal, and without a library function.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::uint64_t state_;
};

struct Cycle {
  double start_s, duration_s, depth_m;
};

Cycle next_cycle(double start_s, Generator& generator) {
  return {start_s, (1 + 0.08 * generator.normal()) / 1.3, 0.015 * (1 + 0.12 * generator.normal())};
}

}  // namespace

int main(int argc, char** argv) {
  const double duration_s = argc == 3 ? std::atof(argv[1]) : 0;
  const double rate_Hz = argc == 3 ? std::atof(argv[2]) : 0;
  if (!(duration_s > 0) || !(rate_Hz > 0)) {
    std::fprintf(stderr, "usage: make_chewing_recording SECONDS RATE_HZ > RECORDING.csv\n");
    return 2;
  }
  constexpr double two_pi = 6.283185307179586;
  constexpr double noise_m = 1e-4;
  Generator cycles(1), noise(2);
  Cycle cycle = next_cycle(0, cycles);
  std::printf("time_s,position_m\n");
  for (std::uint64_t i = 0;; ++i) {
    const double time_s = static_cast<double>(i) / rate_Hz;
    if (time_s >= duration_s) break;
    while (time_s >= cycle.start_s + cycle.duration_s) {
      cycle = next_cycle(cycle.start_s + cycle.duration_s, cycles);
    }
    const double share = (time_s - cycle.start_s) / cycle.duration_s;
    const double opening_m = cycle.depth_m * (1 - std::cos(two_pi * share)) / 2;
    std::printf("%.9f,%.9f\n", time_s, -opening_m + noise_m * noise.normal());
  }
  return std::fflush(stdout) == 0 ? 0 : 2;
}
