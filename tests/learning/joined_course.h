// SPDX-License-Identifier: Apache-2.0
// Motion that changes after something was learned from it.
#pragma once

#include "learning/course.h"

namespace condyle::testing_support {

/// How a motion goes on after `kChange_s`.
enum class SuddenChange { stops, doubles, reverses };

inline constexpr double kChange_s = 40;

/// Cycles of varying length and height, whose velocity changes between two samples at kChange_s.
/// The course ends 5 s later.
Course changing_course(SuddenChange change, double rate_Hz, double noise_m, std::uint64_t seed);

/// Eight kinds of motion end to end, each for kPart_s. Each begins where the last one ended.
inline constexpr double kPart_s = 25;
inline constexpr int kParts = 8;
Course joined_course(double rate_Hz, double noise_m, std::uint64_t seed);

}  // namespace condyle::testing_support
