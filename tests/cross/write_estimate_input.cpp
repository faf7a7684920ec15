// SPDX-License-Identifier: Apache-2.0
// Writes what estimate_bytes reads.
// usage: write_estimate_input RECORDING|spoiled PARAMETERS.toml|default OUT
//   spoiled: SpoiledJaw of bench/filter_cases.h
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "bench/filter_cases.h"
#include "estimate_input.h"
#include "hosted/config/parameter_file.h"
#include "recordings/recording.h"

int main(int argc, char** argv) {
  using namespace condyle;
  if (argc != 4) return 2;
  try {
    cross::EstimateHeader header;
    if (std::string(argv[2]) != "default") {
      header.parameters = host::load_parameters(argv[2]).values;
    }
    header.nominal_step_ns = nanoseconds(header.parameters.sample_time_s);
    std::vector<std::uint8_t> bytes;
    const auto sink = [&bytes](std::uint8_t byte) { bytes.push_back(byte); };
    cross::put_header(header, sink);
    if (std::string(argv[1]) == "spoiled") {
      bench::SpoiledJaw jaw;
      Sample sample;
      for (int i = 0; i < 3000; ++i) {
        const auto next = jaw.next<double>();
        sample.time_ns += nanoseconds(next.step_s);
        sample.coordinates[0] = next.position_m;
        cross::put_sample(sample, sink);
      }
    } else {
      host::RecordingOptions options;
      options.faults = host::FaultPolicy::event;
      const auto recording = host::open_recording(argv[1], options);
      for (Sample sample; recording->next(sample);) cross::put_sample(sample, sink);
    }
    std::FILE* file = std::fopen(argv[3], "wb");
    if (file == nullptr) return 1;
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    return std::fclose(file) == 0 && written ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
