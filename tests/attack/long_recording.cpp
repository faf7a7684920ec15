// SPDX-License-Identifier: Apache-2.0
// Writes a recording of many days, of a jaw that chews for ever, as fast as the disk takes it.
// usage: long_recording FILE.csv|FILE.mcap DAYS RATE_HZ
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <thread>

#include "condyle/hal/log/session_log.h"
#include "hosted/devices/synthetic_source.h"
#include "support/paths.h"

namespace {

using namespace condyle;

// Its time passes only where somebody waits for it.
class JumpingClock final : public hal::Clock {
 public:
  TimeNs now_ns() override { return now_ns_; }
  void sleep_until(TimeNs time_ns) override { now_ns_ = std::max(now_ns_, time_ns); }

 private:
  TimeNs now_ns_ = 0;
};

int write_csv(const std::string& path, std::uint64_t samples, double rate_Hz) {
  std::FILE* const file = std::fopen(path.c_str(), "w");
  if (file == nullptr) return 1;
  std::fputs("time_s,position_m\n", file);
  std::uint32_t random = 1;
  for (std::uint64_t i = 0; i < samples; ++i) {
    random = static_cast<std::uint32_t>(random * std::uint64_t{48271} % 2147483647);
    const double time_s = static_cast<double>(i) / rate_Hz;
    const double noise_m = 1e-4 * (random / 2147483647.0 - 0.5);
    std::fprintf(file, "%.2f,%.6f\n", time_s, 6e-3 * std::sin(2 * time_s) + noise_m);
  }
  return std::fclose(file) == 0 ? 0 : 1;
}

int write_log(const std::string& path, std::uint64_t samples, double rate_Hz) {
  std::ifstream file(testing_support::source_path("/hal/profiles/condyle_facebow.toml"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  hal::SessionHeader header;
  header.software_version = "condyle";
  header.sources.push_back(
      {"facebow",
       0x1209,
       1,
       std::regex_replace(text, std::regex("\nrate_Hz = 500"),
                          "\nrate_Hz = " + std::to_string(static_cast<int>(rate_Hz))),
       {}});
  // The writer's clock is the machine's: a chunk is then about as long as one of the box.
  hal::SessionLogWriter log({.chunk_time_ns = 1'000'000});
  if (log.open(path, header) != hal::SessionLogFailure::none) return 1;
  JumpingClock clock;
  host::SyntheticSource source(rate_Hz, clock);
  if (source.open() != hal::Status::ok) return 1;
  hal::RawReport report;
  for (std::uint64_t i = 0; i < samples; ++i) {
    if (source.read(nanoseconds(1e8), report) != hal::Status::ok) return 1;
    // The writer keeps up with what it has written, half of its ring at most behind.
    while (i - log.status().reports_written > 2000) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (!log.write(0, report)) return 1;
  }
  return log.close() == hal::SessionLogFailure::none ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: long_recording FILE.csv|FILE.mcap DAYS RATE_HZ\n", stderr);
    return 2;
  }
  const std::string path = argv[1];
  const double rate_Hz = std::atof(argv[3]);
  const auto samples = static_cast<std::uint64_t>(std::atof(argv[2]) * 86400 * rate_Hz);
  return path.ends_with(".mcap") ? write_log(path, samples, rate_Hz)
                                 : write_csv(path, samples, rate_Hz);
}
