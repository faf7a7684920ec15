// SPDX-License-Identifier: Apache-2.0
#include "tuning/cross_validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "condyle/estimator/math/innovation_monitor.h"
#include "statistics/moments.h"

namespace condyle::host {
namespace {

// Correlations of standardised innovations within stretches, robust against glitches.
class StretchCorrelation {
 public:
  // `sample`: its index; only successive ones are neighbours.
  void add(std::size_t sample, std::uint32_t stretch, double standardised) {
    const double e = std::clamp(standardised, -3.0, 3.0);
    if (stretch != stretch_ || sample != sample_ + 1) known_ = 0;
    stretch_ = stretch;
    sample_ = sample;
    square_ += e * e;
    ++count_;
    for (std::size_t lag = 1; lag <= known_; ++lag) {
      sum_[lag - 1] += e * past_[lag - 1];
      ++pairs_[lag - 1];
    }
    std::rotate(past_.rbegin(), past_.rbegin() + 1, past_.rend());
    past_[0] = e;
    known_ = std::min(known_ + 1, past_.size());
  }
  void end_recording() { known_ = 0; }
  std::vector<LagCorrelation> values() const {
    std::vector<LagCorrelation> values;
    for (std::size_t i = 0; i < sum_.size(); ++i) {
      if (pairs_[i] == 0 || !(square_ > 0)) break;
      const double pairs = static_cast<double>(pairs_[i]);
      const double variance = square_ / static_cast<double>(count_);
      values.push_back({sum_[i] / pairs / variance, 1.96 / std::sqrt(pairs)});
    }
    return values;
  }

 private:
  std::array<double, CrossValidation::kLags> sum_{}, past_{};
  std::array<std::uint64_t, CrossValidation::kLags> pairs_{};
  double square_ = 0;
  std::uint64_t count_ = 0;
  std::size_t known_ = 0;
  std::uint32_t stretch_ = 0;
  std::size_t sample_ = 0;
};

// Standard error of a mean over samples, from the contributions of stretches.
double standard_error(const std::vector<double>& sums, double mean,
                      const std::vector<std::uint64_t>& counts, std::uint64_t count) {
  if (sums.size() < 2) return std::numeric_limits<double>::infinity();
  double square = 0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double rest = sums[i] - mean * static_cast<double>(counts[i]);
    square += rest * rest;
  }
  const double n = static_cast<double>(sums.size());
  return std::sqrt(square * n / (n - 1)) / static_cast<double>(count);
}

// Probability of correlations as large if all are 0: each is normal, and their squares add up (G.
// E. P. Box, D. A. Pierce, J. Am. Stat. Assoc. 65 (1970) 1509-1526).
double whiteness_probability(const std::vector<LagCorrelation>& correlation) {
  double sum = 0;
  for (const LagCorrelation& lag : correlation) {
    const double deviation = 1.96 * lag.value / lag.bound;
    sum += deviation * deviation;
  }
  return correlation.empty()
             ? 1
             : 1 - chi_square_distribution(sum, static_cast<double>(correlation.size()));
}

// Spread of the stretches' NIS relative to that of a chi-square with 1 degree of freedom.
void judge_dispersion(CrossValidation& check) {
  double sum = 0;
  std::uint64_t stretches = 0;
  for (const StretchInnovations& stretch : check.stretches) {
    if (!stretch.is_held_out || stretch.count < 10) continue;
    const double excess = stretch.mean_nis / check.mean_nis - 1;
    sum += 0.5 * static_cast<double>(stretch.count) * excess * excess;
    ++stretches;
  }
  if (stretches < 2) return;
  const double degrees = static_cast<double>(stretches - 1);
  check.stretch_dispersion = sum / degrees;
  check.dispersion_bound = chi_square_quantile(0.95, degrees) / degrees;
}

}  // namespace

SplitRecording::SplitRecording(const TuningRecording& recording) : recording_(&recording) {
  double duration_s = 0;
  for (const TuningSample& sample : recording.samples) duration_s += sample.step_s;
  // At least six stretches, each with a few innovations.
  const double usual_s = std::min(std::clamp(duration_s / 30, 0.5, 10.0), duration_s / 6);
  stretch_s_ = std::max(usual_s, 25 * recording.median_step_s);
  double time_s = 0;
  stretch_of_.reserve(recording.samples.size());
  for (const TuningSample& sample : recording.samples) {
    time_s += sample.step_s;
    stretch_of_.push_back(static_cast<std::uint32_t>(time_s / stretch_s_));
  }
  if (!stretch_of_.empty()) stretch_count_ = stretch_of_.back() + 1;
}

CrossValidation cross_validate(const std::vector<SplitRecording>& recordings,
                               const NoiseModel& model, const MotionPriorParameters& prior) {
  CrossValidation check;
  StretchCorrelation correlation;
  Moments nis, score;
  std::uint64_t far = 0;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const SplitRecording& split = recordings[r];
    const auto& samples = split.recording().samples;
    const std::size_t first = check.stretches.size();
    for (std::uint32_t i = 0; i < split.stretch_count(); ++i) {
      check.stretches.push_back({r, i * split.stretch_s(), SplitRecording::is_held_out(i)});
    }
    for_each_innovation(samples, model, prior, [&](std::size_t i, const Innovation& innovation) {
      StretchInnovations& stretch = check.stretches[first + split.stretch_of(i)];
      const double e = innovation.standardised();
      ++stretch.count;
      stretch.mean_nis += (e * e - stretch.mean_nis) / static_cast<double>(stretch.count);
      stretch.score += innovation.score();
      if (std::isfinite(samples[i].adaptive_score)) {
        stretch.advantage += innovation.score() - samples[i].adaptive_score;
        ++stretch.compared;
      }
      if (!stretch.is_held_out) return;
      nis.add(e * e);
      score.add(innovation.score());
      correlation.add(i, split.stretch_of(i), e);
      if (std::abs(e) > 3) ++far;
    });
    correlation.end_recording();
  }
  check.count = nis.count();
  check.mean_nis = nis.mean();
  check.score = score.mean();
  // The fitted part, and so the parameters, also vary by chance.
  std::uint64_t all = 0;
  for (const StretchInnovations& stretch : check.stretches) all += stretch.count;
  const std::uint64_t as_good_as = all > 0 ? check.count * (all - check.count) / all : 0;
  check.nis_bounds = mean_chi_square_bounds(1, as_good_as, 0.95);
  check.nis_inside = check.nis_bounds.contains(check.mean_nis);
  check.correlation = correlation.values();
  check.whiteness_p = whiteness_probability(check.correlation);
  check.beyond_3_sd = static_cast<double>(far) / static_cast<double>(check.count);
  judge_dispersion(check);
  std::vector<double> advantages;
  std::vector<std::uint64_t> counts;
  std::uint64_t compared = 0;
  double sum = 0;
  for (const StretchInnovations& stretch : check.stretches) {
    if (!stretch.is_held_out || stretch.compared == 0) continue;
    advantages.push_back(stretch.advantage);
    counts.push_back(stretch.compared);
    compared += stretch.compared;
    sum += stretch.advantage;
  }
  check.advantage = sum / static_cast<double>(compared);
  check.advantage_se = standard_error(advantages, check.advantage, counts, compared);
  return check;
}

ScoreDifference compare_scores(const CrossValidation& one, const CrossValidation& other) {
  std::vector<double> differences;
  std::vector<std::uint64_t> counts;
  double sum = 0;
  for (std::size_t i = 0; i < one.stretches.size(); ++i) {
    const StretchInnovations& stretch = one.stretches[i];
    if (!stretch.is_held_out || stretch.count == 0) continue;
    differences.push_back(stretch.score - other.stretches[i].score);
    counts.push_back(stretch.count);
    sum += differences.back();
  }
  ScoreDifference difference;
  difference.mean = sum / static_cast<double>(one.count);
  difference.standard_error = standard_error(differences, difference.mean, counts, one.count);
  return difference;
}

std::string whiteness_text(const CrossValidation& check) {
  if (check.whiteness_p >= kWhite) {
    return fmt::format("innovations are white up to {} samples apart (p = {:.2f})",
                       check.correlation.size(), check.whiteness_p);
  }
  const auto largest = std::max_element(check.correlation.begin(), check.correlation.end(),
                                        [](const auto& one, const auto& other) {
                                          return std::abs(one.value) < std::abs(other.value);
                                        });
  const auto lag = largest - check.correlation.begin() + 1;
  return fmt::format("innovations are correlated: neighbours {:.2f}{}",
                     check.correlation.front().value,
                     lag > 1 ? fmt::format(", {} samples apart {:.2f}", lag, largest->value) : "");
}

std::vector<std::string> reasons_against_white(const std::vector<SplitRecording>& recordings,
                                               const CrossValidation& check) {
  std::vector<std::string> reasons;
  constexpr std::size_t kMostNamed = 4;
  std::size_t filtered = 0;
  for (const SplitRecording& split : recordings) {
    const TuningRecording& recording = split.recording();
    if (recording.filtered_lag == 0 || ++filtered > kMostNamed) continue;
    reasons.push_back(
        fmt::format("{}: smoothed before recording: neighbouring noise is correlated (sixth "
                    "differences {:.2f}, white noise {:.2f})",
                    recording.name, recording.neighbours, NoiseColour<double>::white(1)));
  }
  if (filtered > kMostNamed) {
    reasons.push_back(fmt::format("{} more recordings were smoothed", filtered - kMostNamed));
  }
  if (check.whiteness_p < kWhite) reasons.push_back(whiteness_text(check));
  if (check.stretch_dispersion > check.dispersion_bound) {
    double lowest = std::numeric_limits<double>::infinity(), highest = 0;
    for (const StretchInnovations& stretch : check.stretches) {
      if (!stretch.is_held_out || stretch.count < 10) continue;
      lowest = std::min(lowest, stretch.mean_nis);
      highest = std::max(highest, stretch.mean_nis);
    }
    reasons.push_back(
        fmt::format("the jerk density of the motion varies: the NIS of stretches ranges from "
                    "{:.2f} to {:.2f}, and one jerk density fits none of them",
                    lowest, highest));
  }
  if (check.beyond_3_sd > 0.01) {
    reasons.push_back(
        fmt::format("{:.1f} % of the innovations are beyond 3 standard deviations (Gaussian: 0.3 "
                    "%): movements that begin or stop suddenly, or glitches",
                    100 * check.beyond_3_sd));
  }
  return reasons;
}

}  // namespace condyle::host
