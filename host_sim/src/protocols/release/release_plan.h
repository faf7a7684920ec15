// SPDX-License-Identifier: Apache-2.0
// The expected precision of a passive release, before it is recorded.
#pragma once

#include <optional>
#include <string>

#include "condyle/estimator/release/release_motion.h"

namespace condyle::host {

/// A planned release.
struct ReleasePlan {
  double rate_Hz = 60, noise_mm = 0.05, duration_s = 0.6;
  double opening_mm = 10;  ///< distance from the rest position to the release
  double damping_rate_per_s = 8, natural_frequency_Hz = 3.183;  ///< kv/m and omega expected
  std::optional<double> wanted_damping_rate_sd_per_s;
};

/// Standard deviations of one release of `duration_s`: the Cramer-Rao bound with rest, start and
/// starting velocity unknown, by the delta method. Not finite if there are too few samples.
ReleaseDeviations<double> expected_deviations(const ReleasePlan& plan, double duration_s);

/// How to reach a standard deviation of kv/m.
struct ReleaseEffort {
  double duration_s = 0;  ///< of each release
  double releases = 1;    ///< number of releases to average
};

/// The shortest single release of up to 10 s that reaches `sd_per_s`; otherwise the number of
/// releases of the shortest duration within 5 % of the best. Nothing if no release determines it.
std::optional<ReleaseEffort> effort_for(const ReleasePlan& plan, double sd_per_s);

/// The plan as text.
std::string plan_text(const ReleasePlan& plan);

}  // namespace condyle::host
