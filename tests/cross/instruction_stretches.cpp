// SPDX-License-Identifier: Apache-2.0
// Steps each filter of bench/filter_cases.h on bare metal, in the precisions the core's FPU has,
// while instruction_counter.cpp counts; prints the cases' names in the order of its reports. First
// each filter on good samples, then with outliers and gaps among them: what its rare paths cost.
#include <new>

#include "bench/filter_cases.h"
#include "test_host.h"

extern "C" {
[[gnu::noipa]] void stretch_begin() {
  asm volatile("nop");
}
[[gnu::noipa]] void stretch_end() {
  asm volatile("nop");
}
[[gnu::noipa]] void stretches_report() {
  asm volatile("nop");
}
}

namespace condyle::cross {
namespace {

using namespace condyle::bench;

constexpr int kSamples = 1000;

/// Does nothing: what counting itself costs.
template <class T>
struct Nothing {
  using Scalar = T;
  static constexpr const char* kName = "nothing";
  void step(Scalar, Scalar) {}
};

// The first sample starts the filter.
template <class Case, class Jaw>
void count(const char* name, const char* samples) {
  using Scalar = typename Case::Scalar;
  alignas(Case) static std::byte memory[sizeof(Case)];
  Case& filter = *new (memory) Case;
  Jaw jaw;
  for (int i = 0; i < kSamples; ++i) {
    const auto sample = jaw.template next<Scalar>();
    stretch_begin();
    one_step(filter, sample.position_m, sample.step_s);
    stretch_end();
  }
  stretches_report();
  print(name);
  print(samples);
  print("\n");
}

template <class Scalar>
void count_all(const char* good, const char* spoiled) {
  const auto both = [&]<class Case>(const char* name) {
    count<Case, ChewingJaw>(name, good);
    count<Case, SpoiledJaw>(name, spoiled);
  };
  both.template operator()<Nothing<Scalar>>(Nothing<Scalar>::kName);
  for_each_filter<Scalar>(both);
}

}  // namespace

int test_program(int, const char* const*) {
  count_all<float>("_float", "_spoiled_float");
#if (__ARM_FP & 8) != 0
  count_all<double>("_double", "_spoiled_double");
#endif
  return 0;
}

}  // namespace condyle::cross
