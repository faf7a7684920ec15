// SPDX-License-Identifier: Apache-2.0
#include "readings/peak_speed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "statistics/chi_square.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr int kLeastWidest = 4;  // samples on both sides
constexpr double kGrowth = 1.22;
// In standard deviations: of the difference between windows that agree.
constexpr double kAgreement = 1.8;
// Probabilities that noise alone looks like a burst to one of the narrower windows: that widens the
// interval, or hides the value.
constexpr double kFalseBurst = 1e-3, kFalseHiding = 1e-4;
constexpr double kRounding = 0.7;  // of that standard deviation: times vary
// How often the estimated error of the value is in the interval; and of the two differences that
// are there if no narrower window could confirm the value.
constexpr double kTimesError = 2, kHidden = 1.5, kUnconfirmed = 1.5, kTooFast = 3,
                 kFar = 1;                // kHidden: sd
constexpr double kMostDifference = 0.25;  // of the speed
// A gap of more steps and more of the wide window may hide a greater speed.
constexpr double kStepsOfGap = 2.5, kGapShare = 0.5;

// What a difference between slopes at one of `places` does not exceed by noise, in its standard
// deviations, whatever its direction.
double burst_threshold(double probability, double places) {
  return std::sqrt(chi_square_quantile(1 - probability / std::max(places, 1.0), 3));
}

bool is_near(std::size_t a, std::size_t b, int width) {
  return std::max(a, b) - std::min(a, b) <= static_cast<std::size_t>(width);
}

}  // namespace

// Where a window's speed is greatest; without a speed if it finds samples nowhere.
struct SpeedReader::Peak {
  int width = 0;
  std::size_t at = 0;
  double speed_m_s = kNowhere;
};

SpeedReader::SpeedReader(const ReferredMotion& motion, SampleRun run, const PoseNoise& noise,
                         const SharedErrors& errors, PathPart part, double widest_s)
    : motion_(motion),
      shared_(noise.shared),
      errors_(errors),
      part_(part),
      slopes_(motion, run, noise, errors, part),
      widest_s_(widest_s) {}

// The peak of each window, from the narrowest to the widest.
std::vector<SpeedReader::Peak> SpeedReader::peaks_of(const Places& places, SampleRun run, int way) {
  std::vector<Peak> peaks;
  const auto longest = static_cast<double>(run.end - run.begin);
  for (double width = kNarrowest;
       width <= std::max<double>(kLeastWidest, widest_s_ / slopes_.step_s()) && width <= longest;
       width = std::max(std::round(width) + 1, width * kGrowth)) {
    Peak peak;
    peak.width = static_cast<int>(std::lround(width));
    const auto take = [&](std::size_t k) {
      const double speed_m_s = slopes_.speed_at(places, k, peak.width, way);
      if (speed_m_s > peak.speed_m_s) {
        peak.speed_m_s = speed_m_s;
        peak.at = k;
      }
    };
    // A wide window's speed changes slowly: first here and there, then around the greatest.
    const auto stride = static_cast<std::size_t>(std::max(1, peak.width / 6));
    for (std::size_t k = run.begin; k < run.end; k += stride) take(k);
    const std::size_t near = peak.at, from = near - std::min(near - run.begin, stride - 1);
    if (!(peak.speed_m_s > 0)) continue;
    for (std::size_t k = from; k < std::min(near + stride, run.end); ++k) take(k);
    peaks.push_back(peak);
  }
  return peaks;
}

// What noise adds to a greatest value: it decides where the peak is found.
double SpeedReader::noise_of_place(const Places& places, const Slope& slope, std::size_t k,
                                   int width, int way, const NoiseAlong& noise) {
  const auto& time_s = slopes_.time_s();
  if (k == 0 || k + 1 >= time_s.size()) return 0;
  const auto reach = static_cast<std::size_t>(std::max(1, width / 2));
  const std::size_t low = k - std::min(k, reach), high = std::min(k + reach, time_s.size() - 1);
  const Slope before = slopes_.slope_at(k - 1, width), after = slopes_.slope_at(k + 1, width);
  const double here = slopes_.speed_at(places, k, width, way),
               behind = slopes_.speed_at(places, low, width, way);
  const double ahead = slopes_.speed_at(places, high, width, way);
  if (before.weights.empty() || after.weights.empty() || slope.weights.empty() ||
      behind == kNowhere || ahead == kNowhere) {
    return 0;
  }
  const double curve =
      2 *
      ((ahead - here) / (time_s[high] - time_s[k]) - (here - behind) / (time_s[k] - time_s[low])) /
      (time_s[high] - time_s[low]);
  if (!(curve < 0)) return 0;
  const double apart_s = time_s[k + 1] - time_s[k - 1];
  return noise.variance_of(after.mixed(1 / apart_s, before, -1 / apart_s)) / (-2 * curve);
}

// The greatest speed of the point at `places` in bursts over which the window `wide` passes, if it
// changes its velocity as the point at `seen` does, whose `noise` decides what a burst is. 0: there
// are none.
double SpeedReader::speed_in_bursts(const Places& places, const Places& seen,
                                    const PointNoise& noise, SampleRun run,
                                    const std::vector<Peak>& peaks, std::size_t wide, int way) {
  const int width = peaks[wide].width;
  double greatest_m_s = 0;
  for (std::size_t i = 0; i < wide; ++i) {
    const int narrow = peaks[i].width;
    const double threshold =
        burst_threshold(kFalseHiding, static_cast<double>(run.end - run.begin) / narrow);
    const double least_m_s =
        kRounding * threshold * slopes_.least_sd_of_difference(narrow, width, noise);
    const auto stride = static_cast<std::size_t>(std::max(1, narrow / 2));
    for (std::size_t k = run.begin; k < run.end; k += stride) {
      if (!slopes_.may_pass_over(seen, k, narrow, width, least_m_s) ||
          !slopes_.passes_over(seen, k, narrow, width, way, noise, threshold)) {
        continue;
      }
      const Vector3d faster = slopes_.velocity_at(places, k, width) +
                              slopes_.velocity_at(seen, k, narrow) -
                              slopes_.velocity_at(seen, k, width);
      greatest_m_s =
          std::max(greatest_m_s, (way == 0 ? faster.norm() : way * faster.z()) +
                                     slopes_.abrupt_change_at(seen, k, narrow, way, noise));
    }
  }
  return greatest_m_s;
}

UncertainValue SpeedReader::greatest(SpeedPoint point, SampleRun run, int way) {
  UncertainValue result;
  result.fixed.assign(errors_.off_by_one_sd.size(), 0);
  result.missing = "too few samples around the greatest speed";
  result.is_hidden = true;
  const Places& places = slopes_.places_of(point);
  if (!(slopes_.step_s() > 0) || run.end <= run.begin || places.empty()) return result;
  const SampleRun searched{run.begin - slopes_.first(), run.end - slopes_.first()};
  const std::vector<Peak> peaks = peaks_of(places, searched, way);
  if (peaks.size() < 3) return result;

  const auto direction_of = [&](const Slope& slope) -> Vector3d {
    return way == 0 ? Vector3d(slope.of(places).normalized()) : Vector3d(0, 0, way);
  };
  std::size_t wide = peaks.size() - 1;
  bool agrees = false;
  for (; wide > 0 && !agrees; --wide) {
    const std::size_t at = peaks[wide].at;
    const Slope slope = slopes_.slope_at(at, peaks[wide].width);
    const Vector3d direction = direction_of(slope);
    const PointNoise of_point = slopes_.noise_of(point, at, slope.of(places));
    const NoiseAlong noise = along(direction, of_point, shared_, slopes_.step_s());
    agrees = true;
    for (std::size_t i = 0; i < wide && agrees; ++i) {
      const Slope narrower = slopes_.slope_at(at, peaks[i].width);
      if (narrower.weights.empty()) continue;
      const Slope difference = slope.mixed(1, narrower, -1);
      agrees = std::abs(direction.dot(difference.of(places))) <=
               kAgreement * std::sqrt(noise.variance_of(difference));
    }
    for (std::size_t i = 0; i < wide && agrees; ++i) {
      // Near the peak there are fewer places to search.
      const double span = is_near(at, peaks[i].at, peaks[wide].width)
                              ? 2.0 * peaks[wide].width
                              : static_cast<double>(run.end - run.begin);
      agrees = !slopes_.passes_over(places, peaks[i].at, peaks[i].width, peaks[wide].width, way,
                                    of_point, burst_threshold(kFalseBurst, span / peaks[i].width));
    }
    if (agrees) break;
  }
  if (!agrees) wide = 1;
  std::size_t narrow = wide - 1;
  while (narrow > 0 && peaks[narrow].width * kNarrower > peaks[wide].width) --narrow;

  const std::size_t at = peaks[agrees ? wide : narrow].at;
  const Slope slope = slopes_.slope_at(at, peaks[narrow].width),
              wider = slopes_.slope_at(at, peaks[wide].width);
  if (slope.weights.empty() || wider.weights.empty() ||
      !(direction_of(slope).dot(slope.of(places)) > 0)) {
    return result;
  }
  const Vector3d velocity = slope.of(places), direction = direction_of(slope);
  const PointNoise point_noise = slopes_.noise_of(point, at, velocity);
  const NoiseAlong noise = along(direction, point_noise, shared_, slopes_.step_s());
  const double ratio = std::pow(static_cast<double>(peaks[narrow].width) / peaks[wide].width, 4);
  const double share = ratio / (1 - ratio);
  const Slope difference = wider.mixed(1, slope, -1);
  const double differs_m_s = direction.dot(difference.of(places));
  const double speed_m_s = direction.dot(velocity);
  // What noise hides may be there in all strokes, whose mean has less noise.
  const double hidden_m_s =
      std::max(std::abs(differs_m_s), kHidden * std::sqrt(noise.variance_of(difference)));
  double smoothing_m_s = !agrees       ? kTooFast * std::abs(differs_m_s)
                         : narrow == 0 ? kUnconfirmed * std::abs(differs_m_s)
                                       : kTimesError * share * hidden_m_s;
  if (narrow == 0) {
    const Slope far = slopes_.slope_at(at, peaks[2].width).mixed(1, slope, -1);
    if (!agrees) {
      smoothing_m_s = std::max(smoothing_m_s, kFar * std::abs(direction.dot(far.of(places))));
    }
  }
  const auto widen_by_change_at = [&](std::size_t k) {
    const int width = peaks[wide].width;
    if (!is_near(at, k, width)) return;
    smoothing_m_s =
        std::max(smoothing_m_s, slopes_.abrupt_change_at(places, k, width, way, point_noise));
  };
  widen_by_change_at(at);
  // The narrowest window's peak is that of its noise.
  for (std::size_t i = 1; i <= wide; ++i) widen_by_change_at(peaks[i].at);
  if (!agrees && std::abs(differs_m_s) > kMostDifference * speed_m_s) {
    result.missing = "the movement is too fast for the rate of the recording";
    return result;
  }
  const double gap_s = longest_gap_s(motion_.time_s, run.begin, run.end);
  if (gap_s > std::max(kStepsOfGap, kGapShare * peaks[wide].width) * slopes_.step_s()) {
    result.missing = fmt::format("a gap of {:.2f} s may hide a greater speed", gap_s);
    return result;
  }
  // The top between the samples: found where the wider window is trusted, read in the other.
  const int finder = peaks[agrees ? wide : narrow].width;
  const auto& time_s = slopes_.time_s();
  double top_m_s = 0;
  if (at > 0 && at + 1 < time_s.size()) {
    const double a = time_s[at - 1] - time_s[at], b = time_s[at + 1] - time_s[at];
    const auto parabola = [&](int width) {
      const double here = slopes_.speed_at(places, at, width, way);
      const double before = slopes_.speed_at(places, at - 1, width, way);
      const double after = slopes_.speed_at(places, at + 1, width, way);
      if (before == kNowhere || after == kNowhere) return std::pair(0.0, 0.0);
      const double p = before - here, q = after - here;
      const double curve = (p * b - q * a) / (a * b * (a - b));
      return std::pair((p - curve * a * a) / a, curve);
    };
    const auto [finder_slope, finder_curve] = parabola(finder);
    if (finder_curve < 0) {
      const double x = std::clamp(-finder_slope / (2 * finder_curve), a / 2, b / 2);
      const auto [read_slope, read_curve] = parabola(peaks[narrow].width);
      top_m_s = (read_slope + read_curve * x) * x;
    }
  }
  const Slope corrected = slope.mixed(1, difference, -share);
  const double sd_m_s = std::sqrt(noise.variance_of(corrected));
  const double across_m_s =
      way == 0 ? across(direction, point_noise, shared_, slopes_.step_s()).variance_of(slope) /
                     (2 * speed_m_s)
               : 0;
  const double of_place =
      std::min(noise_of_place(places, agrees ? wider : slope, at, finder, way, noise), sd_m_s);
  result.missing.clear();
  result.is_hidden = false;
  result.value = 1e3 * (speed_m_s + top_m_s - share * differs_m_s - across_m_s - of_place);
  result.noise_sd = 1e3 * sd_m_s;
  const double overshoot_m_s = slopes_.overshoot_at(places, at, peaks[wide].width, way);
  result.doubt = 1e3 * std::hypot(smoothing_m_s, across_m_s + of_place, overshoot_m_s);
  for (std::size_t i = 0; i < result.fixed.size(); ++i) {
    const Places moved = slopes_.places_of(errors_.off_by_one_sd[i], point, slope.first,
                                           slope.first + slope.weights.size());
    Slope here = slope;
    here.first = 0;
    const Vector3d changed = here.of(moved);
    result.fixed[i] = 1e3 * ((way == 0 ? changed.norm() : way * changed.z()) - speed_m_s);
  }
  for (const SpeedPoint witness : {SpeedPoint::middle, SpeedPoint::incisor}) {
    if (part_ != PathPart::all || witness == point) continue;
    const Places& seen = slopes_.places_of(witness);
    const std::size_t top = peaks[wide].at;
    const PointNoise its_noise =
        slopes_.noise_of(witness, top, slopes_.slope_at(top, peaks[wide].width).of(seen));
    const double most_mm_s =
        1e3 * speed_in_bursts(places, seen, its_noise, searched, peaks, wide, way);
    result.doubt = std::hypot(result.doubt, std::max(most_mm_s - result.value, 0.0));
  }
  if (1e3 * speed_in_bursts(places, places, point_noise, searched, peaks, wide, way) >
      result.value + result.half_interval()) {
    result.value = JawReading::kNone;
    result.is_hidden = true;
    result.missing =
        "a burst of speed is too short for the noise of the recording; less noise or a higher rate "
        "would show it";
  }
  return result;
}

}  // namespace condyle::host
