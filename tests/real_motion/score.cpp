// SPDX-License-Identifier: Apache-2.0
#include "real_motion/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "condyle/estimator/sensors/recommended_parameters.h"
#include "real_motion/order_statistics.h"

namespace condyle::testing_support {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInterval95 = 1.96;

// The mean of what is added; NaN of nothing.
struct Mean {
  double sum = 0;
  std::size_t count = 0;

  void add(double value) {
    sum += value;
    ++count;
  }
  double value() const { return count == 0 ? kNone : sum / static_cast<double>(count); }
};

std::size_t settling_samples(const MotionRecording& recording) {
  const auto samples = static_cast<std::size_t>(0.3 / recording.step_s());
  return std::max(std::min(samples, recording.size() / 8), std::size_t{20});
}

void score_velocity(const ReferenceMotion& reference, const Track& track, std::size_t first,
                    AxisScore& result) {
  Mean square, covered;
  for (std::size_t i = first; i < track.velocity_m_s.size(); ++i) {
    const double error = track.velocity_m_s[i] - reference.velocity_m_s[i];
    if (!std::isfinite(error)) continue;
    square.add(error * error);
    const double sd = std::hypot(track.velocity_sd_m_s[i], reference.velocity_sd_m_s[i]);
    covered.add(std::abs(error) <= kInterval95 * sd ? 1 : 0);
  }
  result.velocity_error_m_s = std::sqrt(square.value());
  result.velocity_coverage = covered.value();
}

void score_next_sample(const ReferenceMotion& reference, const Track& track, std::size_t first,
                       AxisScore& result) {
  Mean covered;
  for (std::size_t i = first; i < track.innovation_m.size(); ++i) {
    if (!reference.is_valid[i]) continue;
    ++result.valid;
    if (track.is_refused[i]) ++result.valid_refused;
    const double standardised = std::abs(track.innovation_m[i]) / track.innovation_sd_m[i];
    if (std::isfinite(standardised)) covered.add(standardised <= kInterval95 ? 1 : 0);
  }
  result.next_coverage = covered.value();
}

// How far `position` is outside of the samples around sample `i` (m).
double distance_outside(const Values& measured, std::size_t i, double position) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (std::size_t j = i < 2 ? 0 : i - 2; j < std::min(i + 3, measured.size()); ++j) {
    low = std::fmin(low, measured[j]);
    high = std::fmax(high, measured[j]);
  }
  return high < low ? 0 : std::max({position - high, low - position, 0.0});
}

void find_runaways(const MotionRecording& recording, const ReferenceMotion& reference,
                   const Track& track, std::size_t first, AxisScore& result) {
  const Marks is_near = to_double(reference.is_irregular, 3);
  const auto is_far = [&](std::size_t i) {
    if (!reference.is_measured[i] || !std::isfinite(track.velocity_m_s[i])) return false;
    const double outside = distance_outside(reference.position_m, i, track.position_m[i]);
    return outside > 5 * track.position_sd_m[i] && outside > 5 * reference.noise_m;
  };
  for (std::size_t i = first; i < recording.size(); ++i) {
    const std::size_t begin = i;
    bool is_regular = false;
    for (; i < recording.size() && is_far(i); ++i) is_regular = is_regular || !is_near[i];
    if (i - begin < 2 || !is_regular) continue;
    ++result.runaways;
    std::ostringstream place;
    place << " runs away for " << i - begin << " samples at " << recording.time_s[begin] << " s;";
    result.places += place.str();
  }
}

void find_deviation_falls(const MotionRecording& recording, const ReferenceMotion& reference,
                          const Track& track, std::size_t first, AxisScore& result) {
  const Values& sd_m = track.position_sd_m;
  for (std::size_t i = std::max<std::size_t>(first, 1); i < recording.size(); ++i) {
    const bool is_taken = reference.is_measured[i] && !track.is_refused[i] && !track.is_repeated[i];
    if (is_taken || track.is_restarted[i] || !(sd_m[i] < 0.99 * sd_m[i - 1])) continue;
    ++result.deviation_falls;
    std::ostringstream place;
    place << " deviation falls from " << sd_m[i - 1] << " to " << sd_m[i] << " m at "
          << recording.time_s[i] << " s;";
    result.places += place.str();
  }
}

}  // namespace

AxisScore score(const MotionRecording& recording, const ReferenceMotion& reference,
                const Track& track) {
  const std::size_t first = settling_samples(recording);
  AxisScore result;
  score_velocity(reference, track, first, result);
  score_next_sample(reference, track, first, result);
  find_runaways(recording, reference, track, first, result);
  find_deviation_falls(recording, reference, track, first, result);
  return result;
}

std::vector<AxisScores> score_axes(const TreatedRecording& treated) {
  constexpr std::size_t kShortest = 80;
  const MotionRecording& recording = treated.recording;
  std::vector<AxisScores> scores;
  if (recording.size() < kShortest) return scores;
  std::vector<ReferenceMotion> references;
  for (std::size_t axis = 0; axis < recording.position_m.size(); ++axis) {
    references.push_back(reference_motion(treated, axis));
  }
  const auto oracle = oracle_tracks(treated, references);
  const auto filter = recommended_tracks(recording, 0);
  const auto recommended = recommended_tracks(recording, kMostKernels);
  const auto published = published_tracks(recording);
  for (std::size_t axis = 0; axis < references.size(); ++axis) {
    if (!references[axis].is_scored) continue;
    const auto of = [&](const std::vector<Track>& tracks) {
      return score(recording, references[axis], tracks[axis]);
    };
    scores.push_back({recording.name, recording.instrument, "xyz"[axis], of(oracle), of(filter),
                      of(recommended), of(published)});
  }
  return scores;
}

std::vector<AxisScores> score_all(const std::vector<MotionRecording>& recordings,
                                  Treatment treatment, unsigned seed) {
  std::vector<AxisScores> scores;
  for (const MotionRecording& recording : recordings) {
    for (AxisScores& axis : score_axes(treat(recording, treatment, seed))) {
      scores.push_back(std::move(axis));
    }
  }
  return scores;
}

AxisScores score_axis(const MotionRecording& recording, const Values& velocity_m_s,
                      double noise_m) {
  const std::size_t n = recording.size();
  ReferenceMotion truth;
  truth.is_known = truth.is_scored = true;
  truth.noise_m = noise_m;
  truth.position_m = recording.position_m[0];
  truth.is_irregular.assign(n, false);
  truth.is_valid.assign(n, true);
  truth.is_measured.assign(n, true);
  truth.velocity_m_s = velocity_m_s;
  truth.velocity_sd_m_s.assign(n, 0);
  const auto of = [&](const std::vector<Track>& tracks) {
    return score(recording, truth, tracks[0]);
  };
  return {recording.name,
          recording.instrument,
          'x',
          of(oracle_tracks({recording, recording}, {truth})),
          of(recommended_tracks(recording, 0)),
          of(recommended_tracks(recording, kMostKernels)),
          of(published_tracks(recording))};
}

Summary summarise(const std::vector<AxisScores>& scores, AxisScore AxisScores::*which) {
  Summary summary;
  Values ratios;
  Mean log_ratio, velocity_coverage, next_coverage;
  std::size_t valid = 0, refused = 0;
  for (const AxisScores& axis : scores) {
    const AxisScore& one = axis.*which;
    const double ratio = one.velocity_error_m_s / axis.oracle.velocity_error_m_s;
    valid += one.valid;
    refused += one.valid_refused;
    summary.runaways += one.runaways;
    summary.deviation_falls += one.deviation_falls;
    if (!std::isfinite(ratio)) continue;
    ++summary.axes;
    ratios.push_back(ratio);
    log_ratio.add(std::log(ratio));
    if (std::isfinite(one.velocity_coverage)) velocity_coverage.add(one.velocity_coverage);
    if (std::isfinite(one.next_coverage)) next_coverage.add(one.next_coverage);
  }
  summary.error_ratio = std::exp(log_ratio.value());
  summary.error_ratio_95th = quantile(ratios, 0.95);
  summary.worst_error_ratio = quantile(ratios, 1);
  summary.velocity_coverage = velocity_coverage.value();
  summary.next_coverage = next_coverage.value();
  summary.refused_percent = 100 * static_cast<double>(refused) / static_cast<double>(valid);
  return summary;
}

}  // namespace condyle::testing_support
