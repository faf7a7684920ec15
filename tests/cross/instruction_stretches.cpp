// SPDX-License-Identifier: Apache-2.0
// Steps each filter of bench/filter_cases.h on bare metal, in the precisions the core's FPU has,
// while instruction_counter.cpp counts; prints the cases' names in the order of its reports. First
// each filter on good samples, then with outliers and gaps among them: what its rarest path costs.
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

// Every 50th sample is a glitch, once in 250 six are, and once the source pauses for half a second.
// The first sample starts the filter.
template <class Scalar>
void spoil(TimedStep<Scalar>& sample, int i) {
  if (i % 50 == 49 || (i % 250 > 100 && i % 250 <= 106)) sample.position_m += Scalar(0.02);
  if (i == 500) sample.step_s = Scalar(0.5);
}

template <class Case>
void count(const char* name, const char* samples, bool is_spoiled) {
  using Scalar = typename Case::Scalar;
  alignas(Case) static std::byte memory[sizeof(Case)];
  Case& filter = *new (memory) Case;
  ChewingJaw jaw;
  for (int i = 0; i < kSamples; ++i) {
    auto sample = jaw.next<Scalar>();
    if (is_spoiled) spoil(sample, i);
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
    count<Case>(name, good, false);
    count<Case>(name, spoiled, true);
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
