// SPDX-License-Identifier: Apache-2.0
#include "tuning/matching_criterion.h"

#include <algorithm>
#include <cmath>

#include "condyle/estimator/published/published_cascade.h"

namespace condyle::host {
namespace {

constexpr double kMostOfTerm = 10, kDivergedPenalty = 10;

double objective_term(double deviation) {
  return deviation < kMostOfTerm ? deviation : kMostOfTerm;  // also for NaN
}

TunedRecording judge_recording(const PublishedRecording& recording, PublishedParameters parameters,
                               double steady_share) {
  parameters.sample_time_s = recording.sample_time_s;
  const std::size_t judged = first_judged_sample(recording);
  PublishedCascade<double> cascade(parameters);
  TunedRecording result;
  // Friction relative to its first judged value: sums of squares keep their digits.
  double count = 0, first = 0, sum = 0, squares = 0, mass_sum = 0, deviations = 0;
  double lowest = 0, highest = 0;
  for (std::size_t i = 0; i < recording.position_m.size(); ++i) {
    const auto estimate = cascade.step(recording.position_m[i]);
    result.verdict = estimate.verdict;
    if (i < judged) continue;
    if (count == 0) first = estimate.friction_Ns_m.value;
    const double friction = estimate.friction_Ns_m.value - first;
    const double deviation = estimate.mass_kg.value / parameters.assumed_mass_kg - 1;
    ++count;
    sum += friction;
    squares += friction * friction;
    lowest = std::min(lowest, friction);
    highest = std::max(highest, friction);
    mass_sum += estimate.mass_kg.value;
    deviations += deviation * deviation;
  }
  const double mean = sum / count;
  result.friction_Ns_m = first + mean;
  result.friction_range = (highest - lowest) / std::abs(result.friction_Ns_m);
  result.mass_kg = mass_sum / count;
  result.mass_deviation = std::sqrt(deviations / count);
  const double unsteadiness =
      std::sqrt(std::max(0.0, squares / count - mean * mean)) / std::abs(result.friction_Ns_m);
  const bool diverged = result.verdict == Verdict::diverged;
  result.objective = objective_term(result.mass_deviation) + objective_term(unsteadiness) +
                     (diverged ? kDivergedPenalty : 0);
  // Each comparison is false for NaN.
  result.satisfies = result.verdict == Verdict::matched &&
                     result.mass_deviation <= kMatchingTolerance && first + lowest > 0 &&
                     result.friction_range <= steady_share;
  return result;
}

}  // namespace

std::size_t first_judged_sample(const PublishedRecording& recording) {
  const auto& position_m = recording.position_m;
  const auto begin =
      std::find_if(position_m.begin(), position_m.end(), [](double z) { return std::isfinite(z); });
  const auto samples = position_m.end() - begin;
  return position_m.size() - static_cast<std::size_t>((samples + 3) / 4);
}

PublishedTuning judge_published_tuning(std::span<const PublishedRecording> recordings,
                                       const PublishedParameters& parameters, double steady_share) {
  PublishedTuning tuning;
  tuning.parameters = parameters;
  tuning.satisfies = true;
  for (const auto& recording : recordings) {
    const TunedRecording tuned = judge_recording(recording, parameters, steady_share);
    tuning.objective += tuned.objective;
    tuning.satisfies = tuning.satisfies && tuned.satisfies;
    tuning.friction_Ns_m += tuned.friction_Ns_m / static_cast<double>(recordings.size());
    tuning.mass_kg += tuned.mass_kg / static_cast<double>(recordings.size());
    tuning.recordings.push_back(tuned);
  }
  return tuning;
}

}  // namespace condyle::host
