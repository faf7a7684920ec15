// SPDX-License-Identifier: Apache-2.0
#include "tuning/starting_values.h"

#include <algorithm>
#include <cmath>

#include "quality/sixth_differences.h"
#include "statistics/moments.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr std::size_t kFewestOfWindow = 24;
constexpr double kWindow_s = 0.5, kLongestStep_s = 0.3;
constexpr double kLeastNoise_m = 1e-7;

struct Window {
  double range_m = 0, noise_m = 0;
};

// Calls `sink(positions)` for each run of positions without gaps.
template <class Sink>
void for_each_run(const TuningRecording& recording, Sink&& sink) {
  std::vector<double> run;
  for (const TuningSample& sample : recording.samples) {
    const bool connects = sample.step_s > 0 && sample.step_s < 1.5 * recording.median_step_s;
    if (!connects || !std::isfinite(sample.position_m)) {
      sink(run);
      run.clear();
    }
    if (std::isfinite(sample.position_m)) run.push_back(sample.position_m);
  }
  sink(run);
}

// Noise in the windows with the least motion; 0 if there is no window.
double rest_noise_m(std::span<const TuningRecording> recordings) {
  std::vector<Window> windows;
  for (const TuningRecording& recording : recordings) {
    const auto samples = static_cast<std::size_t>(kWindow_s / recording.median_step_s);
    const std::size_t length = std::max(kFewestOfWindow, samples);
    for_each_run(recording, [&](const std::vector<double>& run) {
      for (std::size_t begin = 0; begin + length <= run.size(); begin += length) {
        const auto first = run.begin() + static_cast<std::ptrdiff_t>(begin);
        const std::vector<double> window(first, first + static_cast<std::ptrdiff_t>(length));
        const auto [lowest, highest] = std::minmax_element(window.begin(), window.end());
        windows.push_back({*highest - *lowest, noise_by_sixth_differences(window)});
      }
    });
  }
  if (windows.empty()) return 0;
  const std::size_t quiet = windows.size() / 10 + 1;
  std::partial_sort(
      windows.begin(), windows.begin() + static_cast<std::ptrdiff_t>(quiet), windows.end(),
      [](const Window& one, const Window& other) { return one.range_m < other.range_m; });
  std::vector<double> noise;
  for (std::size_t i = 0; i < quiet; ++i) noise.push_back(windows[i].noise_m);
  return upper_median(std::move(noise));
}

// Jerk density from third differences of one recording.
double jerk_density(const TuningRecording& recording, double R) {
  double density = 0;
  for (std::size_t m = 1; static_cast<double>(m) * recording.median_step_s < kLongestStep_s;
       m *= 2) {
    Moments square;
    for_each_run(recording, [&](const std::vector<double>& run) {
      for (std::size_t i = 3 * m; i < run.size(); ++i) {
        const double difference = run[i] - 3 * run[i - m] + 3 * run[i - 2 * m] - run[i - 3 * m];
        square.add(difference * difference);
      }
    });
    if (square.count() == 0) break;
    const double step_s = static_cast<double>(m) * recording.median_step_s;
    const double motion = square.mean() - 20 * R;
    if (motion > 0) density = motion / (0.55 * std::pow(step_s, 5));
    if (square.mean() > 40 * R) break;
  }
  return density;
}

}  // namespace

NoiseModel starting_values(std::span<const TuningRecording> recordings) {
  NoiseModel guess;
  guess.position_sd_m = std::max(rest_noise_m(recordings), kLeastNoise_m);
  std::vector<double> densities;
  for (const TuningRecording& recording : recordings) {
    const double density = jerk_density(recording, guess.position_sd_m * guess.position_sd_m);
    if (density > 0) densities.push_back(density);
  }
  guess.jerk_density_m2_s5 = densities.empty() ? 1 : upper_median(std::move(densities));
  return guess;
}

}  // namespace condyle::host
