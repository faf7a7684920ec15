// SPDX-License-Identifier: Apache-2.0
#include "readings/smoothness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace condyle::host {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kHighest_Hz = 10, kLeastAmplitude = 0.05;
constexpr int kPadding = 4;  // powers of two

// Bins whose amplitudes are computed together, in pairs that fit the processor's registers.
using Pair = double __attribute__((vector_size(16)));
constexpr std::size_t kPairs = 4, kBlock = 2 * kPairs;
using Block = std::array<Pair, kPairs>;

// cos 2 pi k/bins of the bins k = 0, 1, ... up to `last` at least. `bins` is a power of two.
const std::vector<Block>& cosines_of(double bins, std::size_t last) {
  thread_local std::array<std::vector<Block>, 64> all;
  std::vector<Block>& cosines = all[static_cast<std::size_t>(std::ilogb(bins)) % all.size()];
  while (cosines.size() * kBlock <= last) {
    Block block;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const auto bin = static_cast<double>(cosines.size() * kBlock + i);
      block[i / 2][i % 2] = std::cos(2 * std::numbers::pi * bin / bins);
    }
    cosines.push_back(block);
  }
  return cosines;
}

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
  const auto highest =
      static_cast<std::size_t>(std::min(kHighest_Hz / bin_Hz * (1 + 1e-12), bins - 1));
  const std::vector<Block>& cosines = cosines_of(bins, highest);
  std::vector<double> amplitudes;
  amplitudes.reserve(highest + kBlock);
  for (std::size_t block = 0; amplitudes.size() <= highest; ++block) {
    // Goertzel's recurrence, one multiplication for each sample and bin.
    Block twice = cosines[block], last{}, before{};
    for (Pair& cosine : twice) cosine += cosine;
    for (const double v : speed) {
#pragma GCC unroll 4
      for (std::size_t i = 0; i < kPairs; ++i) {
        const Pair next = twice[i] * last[i] - before[i] + v;
        before[i] = last[i];
        last[i] = next;
      }
    }
    for (std::size_t i = 0; i < kPairs; ++i) {
      const Pair square =
          last[i] * last[i] + before[i] * before[i] - twice[i] * last[i] * before[i];
      for (const int lane : {0, 1}) {
        amplitudes.push_back(std::sqrt(std::max(square[lane], 0.0)) / largest);
      }
    }
  }
  std::size_t last = highest;
  while (last > 0 && amplitudes[last] < kLeastAmplitude) --last;
  if (last == 0) return kNone;
  const double df = 1 / static_cast<double>(last);
  double length = 0;
  for (std::size_t i = 1; i <= last; ++i) {
    const double change = amplitudes[i] - amplitudes[i - 1];
    length += std::sqrt(df * df + change * change);
  }
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
