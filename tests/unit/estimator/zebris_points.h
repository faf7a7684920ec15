// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "condyle/estimator/sample.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle::testing_support {

/// Samples of the real bite fork among the reference data (three_points, 50 Hz); none where
/// CONDYLE_REFERENCE_DATA is unset.
inline std::vector<Sample> zebris_samples() {
  const std::string path = reference_data("zebris_jma/JMA_position.txt");
  if (path.empty()) return {};
  std::istringstream text(read_file(path));
  std::string header;
  std::getline(text, header);
  std::getline(text, header);
  std::vector<Sample> samples;
  for (Sample sample{.kind = SampleKind::three_points};; sample.time_ns += 20'000'000) {
    for (double& coordinate_m : sample.coordinates) {
      double value_mm = 0;
      if (!(text >> value_mm)) return samples;
      coordinate_m = value_mm * 1e-3;
    }
    samples.push_back(sample);
  }
}

}  // namespace condyle::testing_support
