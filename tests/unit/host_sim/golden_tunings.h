// SPDX-License-Identifier: Apache-2.0
// Tunings by the published criterion, of the chewing in replay/vectors.
#pragma once

#include <string>
#include <vector>

#include "hosted/config/parameter_file.h"
#include "support/paths.h"
#include "support/table.h"
#include "tuning/published_criterion.h"

namespace condyle::testing_support {

/// The first 12 s of a simulated chewing.
inline host::PublishedRecording golden_chewing(const std::string& name = "chewing_60hz") {
  const Table table =
      read_table(testing_support::source_path("/tests/replay/vectors/") + name + ".positions.csv");
  host::PublishedRecording recording{name, 1.0 / 60, table.numbers("position_m")};
  recording.position_m.resize(720);
  return recording;
}

/// Parameters for it. Their sample time is not the recordings', which must take its place.
inline PublishedParameters golden_parameters(const std::string& name = "chewing_60hz") {
  PublishedParameters parameters =
      host::load_parameters(testing_support::source_path("/tests/replay/vectors/") + name + ".toml")
          .values;
  parameters.sample_time_s = 0.1;
  return parameters;
}

/// What the search finds by `recordings`. 0 threads: as many as there are cores.
inline host::PublishedTuningResult tune(const std::vector<host::PublishedRecording>& recordings,
                                        const host::PublishedTuningPlan& plan = {},
                                        const PublishedParameters& base = golden_parameters(),
                                        unsigned threads = 0) {
  host::MonteCarloControl control;
  control.threads = threads;
  return host::tune_by_published_criterion(recordings, base, plan, {}, control);
}

}  // namespace condyle::testing_support
