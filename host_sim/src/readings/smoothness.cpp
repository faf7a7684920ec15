// SPDX-License-Identifier: Apache-2.0
#include "readings/smoothness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <numbers>
#include <utility>
#include <vector>

namespace condyle::host {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kHighest_Hz = 10, kLeastAmplitude = 0.05;
// What is not known of an amplitude near the threshold; of an arc length at least, and at most,
// which is a lobe as high as the threshold; of LDLJ.
constexpr double kAmplitudeDoubt = 0.1, kLeastDoubt = 0.01, kLobe = 0.1, kJerkDoubt = 0.02;
// The spectrum has a zero between two bins if twice the least amplitude is at most this share of
// the slope beside it. Otherwise it turns smoothly.
constexpr double kLargestZero = 1.5;
constexpr int kPadding = 4;          // powers of two
constexpr std::size_t kStencil = 4;  // of the interpolation

// Bins whose amplitudes are computed together, in pairs that fit the processor's registers.
using Pair = double __attribute__((vector_size(16)));
constexpr std::size_t kPairs = 4, kBlock = 2 * kPairs;
using Block = std::array<Pair, kPairs>;

// cos 2 pi k/bins of the bins k = 0, 1, ... up to `last` at least. `bins` is a power of two.
// Threads share them: mingw-w64 frees what is thread_local before it calls its destructor.
std::shared_ptr<const std::vector<Block>> cosines_of(double bins, std::size_t last) {
  static std::mutex mutex;
  static std::array<std::shared_ptr<const std::vector<Block>>, 64> all;
  const std::lock_guard lock(mutex);
  auto& known = all[static_cast<std::size_t>(std::ilogb(bins)) % all.size()];
  if (known && known->size() * kBlock > last) return known;
  std::vector<Block> cosines = known ? *known : std::vector<Block>();
  while (cosines.size() * kBlock <= last) {
    Block block;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const auto bin = static_cast<double>(cosines.size() * kBlock + i);
      block[i / 2][i % 2] = std::cos(2 * std::numbers::pi * bin / bins);
    }
    cosines.push_back(block);
  }
  return known = std::make_shared<const std::vector<Block>>(std::move(cosines));
}

// Amplitudes up to kHighest_Hz, over that of frequency 0, at multiples of one frequency; empty if
// there are none.
std::vector<double> spectrum_of(const std::vector<double>& speed, double step_s) {
  if (speed.size() < 4 || !(step_s > 0)) return {};
  const double exponent = std::ceil(std::log2(static_cast<double>(speed.size()))) + kPadding;
  const double bins = std::exp2(exponent);
  const double bin_Hz = 1 / (step_s * bins);
  // No bin of a speed, which is nowhere negative, exceeds that of frequency 0.
  double largest = 0;
  for (const double v : speed) largest += v;
  if (!(largest > 0)) return {};
  const auto highest =
      static_cast<std::size_t>(std::min(kHighest_Hz / bin_Hz * (1 + 1e-12), bins - 1));
  const auto cosines = cosines_of(bins, highest);
  std::vector<double> amplitudes;
  amplitudes.reserve(highest + kBlock);
  for (std::size_t block = 0; amplitudes.size() <= highest; ++block) {
    // Goertzel's recurrence, one multiplication for each sample and bin.
    Block twice = (*cosines)[block], last{}, before{};
    for (Pair& cosine : twice) cosine += cosine;
    for (const double v : speed) {
#pragma GCC unroll 4
      for (std::size_t i = 0; i < kPairs; ++i) {
        const Pair next = twice[i] * last[i] + (v - before[i]);  // the shorter chain
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
  amplitudes.resize(highest + 1);
  return amplitudes;
}

// The last frequency with an amplitude of at least `least`.
std::size_t last_of(const std::vector<double>& amplitudes, double least) {
  std::size_t last = amplitudes.empty() ? 0 : amplitudes.size() - 1;
  while (last > 0 && amplitudes[last] < least) --last;
  return last;
}

// Up to that frequency.
double arc_length(const std::vector<double>& amplitudes, double least) {
  const std::size_t last = last_of(amplitudes, least);
  if (last == 0) return kNone;
  const double df = 1 / static_cast<double>(last);
  double length = 0;
  for (std::size_t i = 1; i <= last; ++i) {
    const double change = amplitudes[i] - amplitudes[i - 1];
    length += std::sqrt(df * df + change * change);
  }
  return -length;
}

// Half 95 % interval of what the bins cut off the zeros between lobes: between nothing and the
// slope there, of which twice the least amplitude is in the arc length. Other bins, of a movement
// sampled faster, cut off another part.
double doubt_of_zeros(const std::vector<double>& amplitudes, std::size_t last) {
  double squares = 0;
  for (std::size_t i = 2; i + 2 <= last; ++i) {
    const double here = amplitudes[i];
    if (!(here < amplitudes[i - 1] && here <= amplitudes[i + 1])) continue;
    const double slope =
        std::max(amplitudes[i - 2] - amplitudes[i - 1], amplitudes[i + 2] - amplitudes[i + 1]);
    if (2 * here > kLargestZero * slope) continue;
    const double doubt = std::max(2 * here, slope - 2 * here);
    squares += doubt * doubt;
  }
  return std::sqrt(squares);
}

}  // namespace

double spectral_arc_length(const std::vector<double>& speed, double step_s) {
  return arc_length(spectrum_of(speed, step_s), kLeastAmplitude);
}

double log_dimensionless_jerk(const std::vector<double>& speed, double step_s, EndJerk ends) {
  if (speed.size() < 5 || !(step_s > 0)) return kNone;
  double peak = 0, sum = 0;
  for (const double v : speed) peak = std::max(peak, std::abs(v));
  const auto jerk = [&](std::size_t middle) {
    return (speed[middle + 1] - 2 * speed[middle] + speed[middle - 1]) / (step_s * step_s);
  };
  const std::size_t last = speed.size() - 2;
  for (std::size_t i = 1; i <= last; ++i) sum += jerk(i) * jerk(i) * step_s;
  if (ends == EndJerk::extrapolated) {
    const double first = 2 * jerk(1) - jerk(2), end = 2 * jerk(last) - jerk(last - 1);
    sum += (first * first + end * end) * step_s;
  }
  const double duration_s = static_cast<double>(speed.size()) * step_s;
  return -std::log(duration_s * duration_s * duration_s / (peak * peak) * sum);
}

Smoothness smoothness_of(const std::vector<double>& time_s, const std::vector<double>& speed,
                         double from_s, double to_s) {
  Smoothness none{kNone, kNone, kNone};
  if (!(from_s < to_s)) return none;  // absent, too: a path whose begin or end is not found
  const auto first_inside = std::lower_bound(time_s.begin(), time_s.end(), from_s);
  const auto end_inside = std::upper_bound(first_inside, time_s.end(), to_s);
  const auto inside = static_cast<std::size_t>(end_inside - first_inside);
  if (inside < kStencil) return none;
  const auto first = static_cast<std::size_t>(first_inside - time_s.begin());
  const double step_s = (*(end_inside - 1) - *first_inside) / static_cast<double>(inside - 1);
  const auto parts = static_cast<std::size_t>(std::lround((to_s - from_s) / step_s));
  const double part_s = (to_s - from_s) / static_cast<double>(parts);
  std::vector<double> even;
  even.reserve(parts);
  std::size_t k = 0;  // of the four samples between which the speed is cubic
  for (std::size_t i = 0; i < parts; ++i) {
    const double at_s = from_s + (static_cast<double>(i) + 0.5) * part_s;
    while (k + kStencil < inside && time_s[first + k + kStencil / 2] <= at_s) ++k;
    double value = 0;
    for (std::size_t m = 0; m < kStencil; ++m) {
      const double here_s = time_s[first + k + m];
      double weight = speed[first + k + m];
      for (std::size_t n = 0; n < kStencil; ++n) {
        const double there_s = time_s[first + k + n];
        if (n != m) weight *= (at_s - there_s) / (here_s - there_s);
      }
      value += weight;
    }
    even.push_back(std::max(value, 0.0));
  }
  const std::vector<double> spectrum = spectrum_of(even, part_s);
  const double length = arc_length(spectrum, kLeastAmplitude);
  double doubt = 0;
  for (const double factor : {1 - kAmplitudeDoubt, 1 + kAmplitudeDoubt}) {
    doubt = std::max(doubt, std::abs(arc_length(spectrum, factor * kLeastAmplitude) - length));
  }
  doubt = std::hypot(doubt, doubt_of_zeros(spectrum, last_of(spectrum, kLeastAmplitude)));
  return {length, doubt, log_dimensionless_jerk(even, part_s, EndJerk::extrapolated)};
}

std::array<double, 2> take_arc_length_doubts(std::vector<UncertainValue>& values) {
  std::array<double, 2> doubts{};
  for (const std::size_t back : {std::size_t{1}, std::size_t{0}}) {
    const double doubt = values.back().value;
    doubts[back] = std::isfinite(doubt) ? std::max(doubt, kLeastDoubt) : kLobe;
    values.pop_back();
  }
  return doubts;
}

void widen_smoothness(std::string_view name, const std::array<double, 2>& doubts,
                      const std::vector<SharedNoise>& noise, UncertainValue& value) {
  // Noise decides which lobes count: in each movement anew.
  const double lobes = name == "sparc" ? doubts[0] : name == "closing_sparc" ? doubts[1] : 0;
  value.noise_sd = std::hypot(value.noise_sd, lobes / kHalf95);
  value.contradiction_sd = std::hypot(value.contradiction_sd, lobes / kHalf95);
  if (lobes > 0 && !noise.empty() && value.half_interval() > kLobe) {
    value.value = kNone;
    value.is_hidden = true;
    value.missing =
        "the jaw's tremor, or the instrument's hum or drift, may decide on it: neighbouring "
        "samples "
        "share noise whose spectrum up to 10 Hz is known roughly";
  }
  if (name.ends_with("ldlj")) value.doubt = std::hypot(value.doubt, kJerkDoubt);
}

}  // namespace condyle::host
