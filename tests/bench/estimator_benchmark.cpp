// SPDX-License-Identifier: Apache-2.0
// Time per sample of each filter in filter_cases.h, and how much longer the dense twins take.
// usage: estimator_benchmark [Google Benchmark's options]
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "bench/recorded_cases.h"

namespace condyle::bench {
namespace {

constexpr std::size_t kSamples = 4096;

template <class Case>
void run(benchmark::State& state) {
  const Recording<typename Case::Scalar> recording(kSamples);
  Case filter;
  for (auto _ : state) {
    for (std::size_t i = 0; i < kSamples; ++i) {
      filter.step(recording.positions_m[i], recording.steps_s[i]);
    }
    benchmark::DoNotOptimize(filter);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kSamples));
}

// Keeps the shortest time of each case's repetitions.
class Reporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& one : runs) {
      if (one.run_type != Run::RT_Iteration || one.iterations == 0) continue;
      const double ns = one.cpu_accumulated_time * 1e9 / static_cast<double>(one.iterations) /
                        static_cast<double>(kSamples);
      const auto found = ns_.try_emplace(one.run_name.function_name, ns).first;
      found->second = std::min(found->second, ns);
    }
  }

  void print_ratios() const {
    std::printf("\n%-28s%12s%24s\n", "shortest of repetitions", "ns/sample", "dense twin / this");
    for (const auto& [name, ns] : ns_) {
      std::printf("%-28s%12.1f", name.c_str(), ns);
      const std::size_t published = name.find("published_");
      const auto dense = published == 0 ? ns_.find("dense_" + name.substr(10)) : ns_.end();
      if (dense != ns_.end()) std::printf("%24.2f", dense->second / ns);
      std::printf("\n");
    }
  }

 private:
  std::map<std::string, double> ns_;
};

}  // namespace
}  // namespace condyle::bench

int main(int argc, char** argv) {
  using namespace condyle::bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  for_each_case([]<class Case>(const std::string& name) {
    benchmark::RegisterBenchmark(name.c_str(), run<Case>)
        ->MinTime(0.1)
        ->Repetitions(5)
        ->Unit(benchmark::kMicrosecond);
  });
  Reporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.print_ratios();
  return 0;
}
