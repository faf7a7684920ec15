// SPDX-License-Identifier: Apache-2.0
#include "readings/smoothness.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace condyle::host {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kHighest_Hz = 10, kLeastAmplitude = 0.05;
constexpr int kPadding = 4;  // powers of two

}  // namespace

double spectral_arc_length(const std::vector<double>& speed, double step_s) {
  if (speed.size() < 4 || !(step_s > 0)) return kNone;
  const double exponent = std::ceil(std::log2(static_cast<double>(speed.size()))) + kPadding;
  const double bins = std::exp2(exponent);
  const double bin_Hz = 1 / (step_s * bins);
  // No bin of a speed, which is nowhere negative, exceeds that of frequency 0.
  double largest = 0;
  for (const double v : speed) largest += v;
  if (!(largest > 0)) return kNone;
  std::vector<double> amplitudes;
  const double highest = std::min(kHighest_Hz / bin_Hz * (1 + 1e-12), bins - 1);
  for (double bin = 0; bin <= highest; ++bin) {
    const std::complex<double> turn = std::polar(1.0, -2 * std::numbers::pi * bin / bins);
    std::complex<double> sum = 0;
    for (auto v = speed.rbegin(); v != speed.rend(); ++v) sum = sum * turn + *v;
    amplitudes.push_back(std::abs(sum) / largest);
  }
  std::size_t last = amplitudes.size() - 1;
  while (last > 0 && amplitudes[last] < kLeastAmplitude) --last;
  if (last == 0) return kNone;
  const double df = 1 / static_cast<double>(last);
  double length = 0;
  for (std::size_t i = 1; i <= last; ++i)
    length += std::hypot(df, amplitudes[i] - amplitudes[i - 1]);
  return -length;
}

double log_dimensionless_jerk(const std::vector<double>& speed, double step_s) {
  if (speed.size() < 5 || !(step_s > 0)) return kNone;
  double peak = 0, sum = 0;
  for (const double v : speed) peak = std::max(peak, std::abs(v));
  for (std::size_t i = 2; i < speed.size(); ++i) {
    const double jerk = (speed[i] - 2 * speed[i - 1] + speed[i - 2]) / (step_s * step_s);
    sum += jerk * jerk * step_s;
  }
  const double duration_s = static_cast<double>(speed.size()) * step_s;
  return -std::log(duration_s * duration_s * duration_s / (peak * peak) * sum);
}

}  // namespace condyle::host
