// SPDX-License-Identifier: Apache-2.0
#include "simulation/facebow_section.h"

#include <fmt/format.h>

#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

constexpr Range kNonNegative{0, 1e9};
constexpr double kMostJitter = 0.2;  // of the sampling period

}  // namespace

void read_facebow(TomlReader& file, FacebowModel& facebow) {
  file.number("facebow", "rate_Hz", facebow.rate_Hz, "Hz", {1, 5000});
  file.number("facebow", "jitter_s", facebow.jitter_s, "s", {0, 0.1});
  if (facebow.jitter_s > kMostJitter / facebow.rate_Hz) {
    throw InputError(file.place("facebow", "jitter_s"),
                     "is more than a fifth of the sampling period",
                     fmt::format("give at most {:.3g} s", kMostJitter / facebow.rate_Hz));
  }
  file.number("facebow", "clock_drift", facebow.clock_drift, "share", {-0.1, 0.1});
  file.number("facebow", "latency_s", facebow.latency_s, "s", {0, 10});
  file.number("facebow", "noise_m", facebow.noise_m, "m", {0, 0.01});
  file.number("facebow", "noise_rad", facebow.noise_rad, "rad", {0, 0.1});
  file.number("facebow", "smoothing", facebow.smoothing, "share", {0, 0.999});
  file.number("facebow", "quantum_m", facebow.quantum_m, "m", {0, 0.01});
  file.number("facebow", "lost_share", facebow.lost_share, "share", {0, 0.99});
  file.number("facebow", "repeated_share", facebow.repeated_share, "share", {0, 0.99});
  file.number("facebow", "glitch_share", facebow.glitch_share, "share", Range{0, 1});
  const auto stretch = [&](const std::string& name, Stretch& value) {
    file.number("facebow", name + "_start_s", value.start_s, "s", kNonNegative);
    file.number("facebow", name + "_duration_s", value.duration_s, "s", kNonNegative);
  };
  stretch("dropout", facebow.dropout);
  stretch("frozen", facebow.frozen);
}

}  // namespace condyle::host
