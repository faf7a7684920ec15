// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "condyle/estimator/sample.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle::testing_support {

/// Samples of a real bite fork among the reference data (three_points, 50 Hz): its three markers,
/// tracked by a Zebris instrument and smoothed by its maker. None where CONDYLE_REFERENCE_DATA is
/// unset.
inline std::vector<Sample> zebris_samples() {
  std::vector<Sample> samples;
  for (int marker = 0; marker < 3; ++marker) {
    const std::string path =
        reference_data("zebris_jma/marker" + std::to_string(marker + 1) + ".txt");
    if (path.empty()) return {};
    std::istringstream text(read_file(path));
    std::string header;
    std::getline(text, header);
    std::getline(text, header);
    double value_mm = 0;
    for (std::size_t i = 0; text >> value_mm; ++i) {
      if (i / 3 == samples.size()) {
        samples.push_back({.kind = SampleKind::three_points});
        samples.back().time_ns = 20'000'000 * static_cast<TimeNs>(i / 3);
      }
      samples[i / 3].coordinates[3 * static_cast<std::size_t>(marker) + i % 3] = value_mm * 1e-3;
    }
  }
  return samples;
}

}  // namespace condyle::testing_support
