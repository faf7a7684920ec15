// SPDX-License-Identifier: Apache-2.0
// The paper's tuning criterion: stage 3 returns the assumed mass. It judges the tuning, not the
// subject: the assumed mass solves stage 3's model for every motion.
#pragma once

#include <cmath>
#include <cstdint>

namespace condyle {

/// Verdict of the matching criterion on the run so far.
enum class Verdict : std::uint8_t { not_matched, matched, diverged };

/// Name of a verdict in summaries.
constexpr const char* verdict_name(Verdict verdict) {
  constexpr const char* names[] = {"not matched", "matched", "diverged"};
  return names[static_cast<int>(verdict)];
}

/// Relative distance from the assumed mass within which the mass counts as matched. The paper does
/// not give a number.
inline constexpr double kMatchingTolerance = 0.02;

/// Running verdict, constant memory:
///   diverged  the mass was not positive or not finite at any sample
///   matched   |m - m0| <= 2 % of m0 at every sample of the last quarter of the run
class MatchingCriterion {
 public:
  /// Takes the mass of the next sample; returns the verdict on the run up to it.
  template <class Scalar>
  Verdict add(Scalar mass_kg, Scalar assumed_mass_kg) {
    const std::uint64_t index = count_++;
    if (!std::isfinite(mass_kg) || !(mass_kg > Scalar(0))) diverged_ = true;
    if (!(std::abs(mass_kg - assumed_mass_kg) <= Scalar(kMatchingTolerance) * assumed_mass_kg)) {
      last_outside_ = index + 1;
    }
    if (diverged_) return Verdict::diverged;
    const std::uint64_t first_of_last_quarter = count_ - (count_ + 3) / 4;
    return last_outside_ <= first_of_last_quarter ? Verdict::matched : Verdict::not_matched;
  }

 private:
  std::uint64_t count_ = 0;
  std::uint64_t last_outside_ = 0;  // number of samples up to the last one outside the tolerance
  bool diverged_ = false;
};

}  // namespace condyle
