// SPDX-License-Identifier: Apache-2.0
// Measures of functions of time, for the truth.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "simulation/kinematic/kinematic_jaw.h"

namespace condyle::host::truth {

inline constexpr double kStep_s = 0.5e-3;
inline constexpr double kDegrees = 180 / std::numbers::pi;

using Function = std::function<double(double)>;

struct Span {
  double begin_s, end_s;
};

/// Calls `use` at instants from begin to end, both included, at most kStep_s apart.
template <class Use>
void at_instants(const Span& span, Use use) {
  const auto steps = std::max(1L, std::lround(std::ceil((span.end_s - span.begin_s) / kStep_s)));
  for (long i = 0; i <= steps; ++i) {
    use(span.begin_s +
        (span.end_s - span.begin_s) * static_cast<double>(i) / static_cast<double>(steps));
  }
}

/// The greatest value.
double greatest(const Function& value, const Span& span);
/// When it is reached.
double greatest_at_s(const Function& value, const Span& span);
/// First instant at which `value` reaches `level` from below.
std::optional<double> first_passage_s(const Function& value, const Span& span, double level);

/// Where `value`, from `inside_s` towards `limit_s`, first falls below `level`; if nowhere, the
/// limit.
double fall_s(const Function& value, double inside_s, double limit_s, double level);

/// The integral, by Simpson's rule in steps of kStep_s.
double integral(const Function& value, const Span& span);

/// SPARC and LDLJ (Balasubramanian et al. 2015) of a speed; of the part about its peak that is at
/// least `least_share` of it. Both are defined for samples: the middles of parts of about kStep_s.
struct TrueSmoothness {
  double sparc, ldlj;
};
TrueSmoothness smoothness(const Function& speed, const Span& span, double least_share);

/// Of a point.
using PathFunction = std::function<Eigen::Vector3d(double)>;
double speed_mm_s(const PathFunction& place_mm, double time_s);
Eigen::Vector3d velocity_mm_s(const PathFunction& place_mm, double time_s);

/// Displacement of the jaw's point from the reference position in A (mm).
Eigen::Vector3d displacement_mm(const JawPose& pose, const Eigen::Vector3d& point_m);

/// Rotation about Y: the twist of swing and twist.
double opening_angle_deg(const Eigen::Matrix3d& rotation);

}  // namespace condyle::host::truth
