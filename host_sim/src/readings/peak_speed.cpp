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
// How often the estimated error of the value is in the interval (kHidden: sd); and of the two
// differences that are there if no narrower window could confirm the value.
constexpr double kTimesError = 2, kHidden = 1.5, kUnconfirmed = 1.5, kTooFast = 3;
constexpr double kMoreInBurst = 2;        // sd: how much faster than read a burst may be
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

// The search for the greatest speed of one point.
class SpeedReader::Search {
 public:
  Search(SpeedReader& reader, SpeedPoint point, SampleRun run, int way)
      : reader_(reader),
        slopes_(reader.slopes_),
        point_(point),
        run_{run.begin - slopes_.first(), run.end - slopes_.first()},
        way_(way),
        places_(slopes_.places_of(point)) {}

  UncertainValue greatest();

 private:
  // Where a window's speed is greatest; without a speed if it finds samples nowhere.
  struct Peak {
    int width = 0;
    std::size_t at = 0;
    double speed_m_s = kNowhere;
  };

  void find_peaks();
  bool agrees_at_its_peak(std::size_t i) const;
  bool passes_over_no_burst(std::size_t i) const;
  bool choose_windows();
  std::string problem() const;
  double smoothing_m_s() const;
  double top_m_s();
  double noise_of_place() const;
  double speed_in_bursts(const Places& seen, const PointNoise& noise);
  double speed_in_bursts_of_widest();
  double beyond_by_witness_mm_s(SpeedPoint witness, double value_mm_s);
  std::vector<double> fixed_mm_s() const;

  Vector3d direction_of(const Slope& slope) const {
    return way_ == 0 ? Vector3d(slope.of(places_).normalized()) : Vector3d(0, 0, way_);
  }
  NoiseAlong along_direction(const Vector3d& direction, const PointNoise& noise) const {
    return along(direction, noise, reader_.shared_, slopes_.step_s());
  }
  // The window that is trusted to find the peak.
  const Peak& finder() const { return peaks_[agrees_ ? wide_ : narrow_]; }

  SpeedReader& reader_;
  WindowSlopes& slopes_;
  SpeedPoint point_;
  SampleRun run_;  // of the slopes
  int way_;
  const Places& places_;
  std::vector<Peak> peaks_;  // from the narrowest window to the widest

  // W, N and n of peak_speed.h, and whether N agrees with the narrower ones.
  std::size_t widest_ = 0, wide_ = 0, narrow_ = 0;
  bool agrees_ = false;
  // Of n, of N, and the latter less the former, at the peak.
  std::size_t at_ = 0;
  Slope slope_, wider_, difference_;
  Vector3d direction_;
  PointNoise point_noise_;
  NoiseAlong noise_;
  double speed_m_s_ = 0, differs_m_s_ = 0;
  double share_ = 0;  // of the difference, the error of n
};

void SpeedReader::Search::find_peaks() {
  const auto longest = static_cast<double>(run_.end - run_.begin);
  for (double width = kNarrowest;
       width <= std::max<double>(kLeastWidest, reader_.widest_s_ / slopes_.step_s()) &&
       width <= longest;
       width = std::max(std::round(width) + 1, width * kGrowth)) {
    Peak peak;
    peak.width = static_cast<int>(std::lround(width));
    const auto take = [&](std::size_t k) {
      const double speed_m_s = slopes_.speed_at(places_, k, peak.width, way_);
      if (speed_m_s > peak.speed_m_s) {
        peak.speed_m_s = speed_m_s;
        peak.at = k;
      }
    };
    // A wide window's speed changes slowly: first here and there, then around the greatest.
    const auto stride = static_cast<std::size_t>(std::max(1, peak.width / 6));
    for (std::size_t k = run_.begin; k < run_.end; k += stride) take(k);
    const std::size_t near = peak.at, from = near - std::min(near - run_.begin, stride - 1);
    if (!(peak.speed_m_s > 0)) continue;
    for (std::size_t k = from; k < std::min(near + stride, run_.end); ++k) take(k);
    peaks_.push_back(peak);
  }
}

// Whether the slope of window `wide` agrees with those of all narrower ones at its own peak.
bool SpeedReader::Search::agrees_at_its_peak(std::size_t wide) const {
  const std::size_t at = peaks_[wide].at;
  const Slope slope = slopes_.slope_at(at, peaks_[wide].width);
  const Vector3d direction = direction_of(slope);
  const PointNoise of_point = slopes_.noise_of(point_, at, slope.of(places_));
  const NoiseAlong noise = along_direction(direction, of_point);
  for (std::size_t i = 0; i < wide; ++i) {
    const Slope narrower = slopes_.slope_at(at, peaks_[i].width);
    if (narrower.weights.empty()) continue;
    const Slope difference = slope.mixed(1, narrower, -1);
    if (std::abs(direction.dot(difference.of(places_))) >
        kAgreement * std::sqrt(noise.variance_of(difference))) {
      return false;
    }
  }
  return true;
}

// Whether it passes over no burst at their peaks.
bool SpeedReader::Search::passes_over_no_burst(std::size_t wide) const {
  const std::size_t at = peaks_[wide].at;
  const PointNoise of_point =
      slopes_.noise_of(point_, at, slopes_.slope_at(at, peaks_[wide].width).of(places_));
  for (std::size_t i = 0; i < wide; ++i) {
    // Near the peak there are fewer places to search.
    const double span = is_near(at, peaks_[i].at, peaks_[wide].width)
                            ? 2.0 * peaks_[wide].width
                            : static_cast<double>(run_.end - run_.begin);
    if (slopes_.passes_over(places_, peaks_[i].at, peaks_[i].width, peaks_[wide].width, way_,
                            of_point, burst_threshold(kFalseBurst, span / peaks_[i].width))) {
      return false;
    }
  }
  return true;
}

// False if there are too few samples.
bool SpeedReader::Search::choose_windows() {
  find_peaks();
  if (peaks_.size() < 3) return false;
  widest_ = peaks_.size() - 1;
  while (widest_ > 0 && !agrees_at_its_peak(widest_)) --widest_;
  wide_ = widest_;
  while (wide_ > 0 && !(agrees_at_its_peak(wide_) && passes_over_no_burst(wide_))) --wide_;
  agrees_ = wide_ > 0;
  if (!agrees_) wide_ = 1;
  narrow_ = wide_ - 1;
  while (narrow_ > 0 && peaks_[narrow_].width * kNarrower > peaks_[wide_].width) --narrow_;

  at_ = finder().at;
  slope_ = slopes_.slope_at(at_, peaks_[narrow_].width);
  wider_ = slopes_.slope_at(at_, peaks_[wide_].width);
  if (slope_.weights.empty() || wider_.weights.empty()) return false;
  const Vector3d velocity = slope_.of(places_);
  direction_ = direction_of(slope_);
  speed_m_s_ = direction_.dot(velocity);
  if (!(speed_m_s_ > 0)) return false;
  point_noise_ = slopes_.noise_of(point_, at_, velocity);
  noise_ = along_direction(direction_, point_noise_);
  difference_ = wider_.mixed(1, slope_, -1);
  differs_m_s_ = direction_.dot(difference_.of(places_));
  const double ratio =
      std::pow(static_cast<double>(peaks_[narrow_].width) / peaks_[wide_].width, 4);
  share_ = ratio / (1 - ratio);
  return true;
}

// Why the speed is not known; empty: it is.
std::string SpeedReader::Search::problem() const {
  if (!agrees_ && std::abs(differs_m_s_) > kMostDifference * speed_m_s_) {
    return "the movement is too fast for the rate of the recording";
  }
  const double gap_s = longest_gap_s(slopes_.time_s(), run_.begin, run_.end);
  if (gap_s > std::max(kStepsOfGap, kGapShare * peaks_[wide_].width) * slopes_.step_s()) {
    return fmt::format("a gap of {:.2f} s may hide a greater speed", gap_s);
  }
  return "";
}

// What smoothing may have changed.
double SpeedReader::Search::smoothing_m_s() const {
  // What noise hides may be there in all strokes, whose mean has less noise.
  const double hidden_m_s =
      std::max(std::abs(differs_m_s_), kHidden * std::sqrt(noise_.variance_of(difference_)));
  double most_m_s = !agrees_       ? kTooFast * std::abs(differs_m_s_)
                    : narrow_ == 0 ? kUnconfirmed * hidden_m_s
                                   : kTimesError * share_ * hidden_m_s;
  if (!agrees_ && narrow_ == 0) {
    const Slope far = slopes_.slope_at(at_, peaks_[2].width).mixed(1, slope_, -1);
    most_m_s = std::max(most_m_s, std::abs(direction_.dot(far.of(places_))));
  }
  const int width = peaks_[wide_].width;
  const auto widen_by_change_at = [&](std::size_t k) {
    if (!is_near(at_, k, width)) return;
    most_m_s = std::max(most_m_s, slopes_.abrupt_change_at(places_, k, width, way_, point_noise_));
  };
  widen_by_change_at(at_);
  // The narrowest window's peak is that of its noise.
  for (std::size_t i = 1; i <= wide_; ++i) widen_by_change_at(peaks_[i].at);
  return most_m_s;
}

// How far the top between the samples lies above the peak: found where the wider window is trusted,
// read in the other.
double SpeedReader::Search::top_m_s() {
  const auto& time_s = slopes_.time_s();
  if (at_ == 0 || at_ + 1 >= time_s.size()) return 0;
  const double a = time_s[at_ - 1] - time_s[at_], b = time_s[at_ + 1] - time_s[at_];
  const auto parabola = [&](int width) {
    const double here = slopes_.speed_at(places_, at_, width, way_);
    const double before = slopes_.speed_at(places_, at_ - 1, width, way_);
    const double after = slopes_.speed_at(places_, at_ + 1, width, way_);
    if (before == kNowhere || after == kNowhere) return std::pair(0.0, 0.0);
    const double p = before - here, q = after - here;
    const double curve = (p * b - q * a) / (a * b * (a - b));
    return std::pair((p - curve * a * a) / a, curve);
  };
  const auto [finder_slope, finder_curve] = parabola(finder().width);
  if (!(finder_curve < 0)) return 0;
  const double x = std::clamp(-finder_slope / (2 * finder_curve), a / 2, b / 2);
  const auto [read_slope, read_curve] = parabola(peaks_[narrow_].width);
  return (read_slope + read_curve * x) * x;
}

// What noise adds to a greatest value: it decides where the peak is found.
double SpeedReader::Search::noise_of_place() const {
  const auto& time_s = slopes_.time_s();
  const int width = finder().width;
  const Slope& slope = agrees_ ? wider_ : slope_;
  if (at_ == 0 || at_ + 1 >= time_s.size()) return 0;
  const auto reach = static_cast<std::size_t>(std::max(1, width / 2));
  const std::size_t low = at_ - std::min(at_, reach),
                    high = std::min(at_ + reach, time_s.size() - 1);
  const Slope before = slopes_.slope_at(at_ - 1, width), after = slopes_.slope_at(at_ + 1, width);
  const double here = slopes_.speed_at(places_, at_, width, way_),
               behind = slopes_.speed_at(places_, low, width, way_);
  const double ahead = slopes_.speed_at(places_, high, width, way_);
  if (before.weights.empty() || after.weights.empty() || slope.weights.empty() ||
      behind == kNowhere || ahead == kNowhere) {
    return 0;
  }
  const double curve = 2 *
                       ((ahead - here) / (time_s[high] - time_s[at_]) -
                        (here - behind) / (time_s[at_] - time_s[low])) /
                       (time_s[high] - time_s[low]);
  if (!(curve < 0)) return 0;
  const double apart_s = time_s[at_ + 1] - time_s[at_ - 1];
  return noise_.variance_of(after.mixed(1 / apart_s, before, -1 / apart_s)) / (-2 * curve);
}

// The greatest speed of the point in bursts over which N passes, if it changes its velocity as the
// point at `seen` does, whose `noise` decides what a burst is. 0: there are none.
double SpeedReader::Search::speed_in_bursts(const Places& seen, const PointNoise& noise) {
  const int width = peaks_[wide_].width;
  double greatest_m_s = 0;
  for (std::size_t i = 0; i < wide_; ++i) {
    const int narrow = peaks_[i].width;
    const double threshold =
        burst_threshold(kFalseHiding, static_cast<double>(run_.end - run_.begin) / narrow);
    const double least_m_s =
        kRounding * threshold * slopes_.least_sd_of_difference(narrow, width, noise);
    const auto stride = static_cast<std::size_t>(std::max(1, narrow / 2));
    for (std::size_t k = run_.begin; k < run_.end; k += stride) {
      if (!slopes_.may_pass_over(seen, k, narrow, width, least_m_s)) continue;
      if (!slopes_.passes_over(seen, k, narrow, width, way_, noise, threshold)) continue;
      const Vector3d faster = slopes_.velocity_at(places_, k, width) +
                              slopes_.velocity_at(seen, k, narrow) -
                              slopes_.velocity_at(seen, k, width);
      greatest_m_s =
          std::max(greatest_m_s, (way_ == 0 ? faster.norm() : way_ * faster.z()) +
                                     slopes_.abrupt_change_at(seen, k, narrow, way_, noise));
    }
  }
  return greatest_m_s;
}

// How fast it may be in bursts over which W passes, away from the peak, by n. 0: there are none.
double SpeedReader::Search::speed_in_bursts_of_widest() {
  const int width = peaks_[widest_].width, narrow = peaks_[narrow_].width;
  if (widest_ <= wide_) return 0;
  const double threshold =
      burst_threshold(kFalseHiding, static_cast<double>(run_.end - run_.begin) / narrow);
  double greatest_m_s = 0;
  for (std::size_t k = run_.begin; k < run_.end; ++k) {
    if (is_near(k, at_, peaks_[wide_].width)) continue;  // there the interval tells
    const double speed_m_s = slopes_.speed_at(places_, k, narrow, way_);
    if (speed_m_s > greatest_m_s &&
        slopes_.passes_over(places_, k, narrow, width, way_, point_noise_, threshold)) {
      greatest_m_s = speed_m_s;
    }
  }
  return greatest_m_s > 0 ? greatest_m_s + kMoreInBurst * std::sqrt(noise_.variance_of(slope_)) : 0;
}

// How far the speed may lie above `value_mm_s` in bursts that `witness` shows.
double SpeedReader::Search::beyond_by_witness_mm_s(SpeedPoint witness, double value_mm_s) {
  if (reader_.part_ != PathPart::all || witness == point_) return 0;
  const Places& seen = slopes_.places_of(witness);
  const Peak& top = peaks_[wide_];
  const PointNoise noise =
      slopes_.noise_of(witness, top.at, slopes_.slope_at(top.at, top.width).of(seen));
  return std::max(1e3 * speed_in_bursts(seen, noise) - value_mm_s, 0.0);
}

// What each error that strokes share changes.
std::vector<double> SpeedReader::Search::fixed_mm_s() const {
  std::vector<double> fixed;
  for (const ReadingGeometry& off : reader_.errors_.off_by_one_sd) {
    const Places moved =
        slopes_.places_of(off, point_, slope_.first, slope_.first + slope_.weights.size());
    Slope here = slope_;
    here.first = 0;
    const Vector3d changed = here.of(moved);
    fixed.push_back(1e3 * ((way_ == 0 ? changed.norm() : way_ * changed.z()) - speed_m_s_));
  }
  return fixed;
}

UncertainValue SpeedReader::Search::greatest() {
  UncertainValue result;
  result.fixed.assign(reader_.errors_.off_by_one_sd.size(), 0);
  result.missing = "too few samples around the greatest speed";
  result.is_hidden = true;
  if (!(slopes_.step_s() > 0) || run_.end <= run_.begin || places_.empty()) return result;
  if (choose_windows()) result.missing = problem();
  if (!result.missing.empty()) return result;

  const double sd_m_s = std::sqrt(noise_.variance_of(slope_.mixed(1, difference_, -share_)));
  const double across_m_s =
      way_ == 0 ? across(direction_, point_noise_, reader_.shared_, slopes_.step_s())
                          .variance_of(slope_) /
                      (2 * speed_m_s_)
                : 0;
  const double of_place_m_s = std::min(noise_of_place(), sd_m_s);
  const double overshoot_m_s = slopes_.overshoot_at(places_, at_, peaks_[wide_].width, way_);
  result.is_hidden = false;
  result.value = 1e3 * (speed_m_s_ + top_m_s() - share_ * differs_m_s_ - across_m_s - of_place_m_s);
  result.noise_sd = 1e3 * sd_m_s;
  result.doubt = 1e3 * std::hypot(smoothing_m_s(), across_m_s + of_place_m_s, overshoot_m_s);
  result.fixed = fixed_mm_s();
  for (const SpeedPoint witness : {SpeedPoint::middle, SpeedPoint::incisor}) {
    result.doubt = std::hypot(result.doubt, beyond_by_witness_mm_s(witness, result.value));
  }
  if (1e3 * std::max(speed_in_bursts(places_, point_noise_), speed_in_bursts_of_widest()) >
      result.value + result.half_interval()) {
    result.value = JawReading::kNone;
    result.is_hidden = true;
    result.missing =
        "a burst of speed is too short for the noise of the recording; less noise or a higher rate "
        "would show it";
  }
  return result;
}

SpeedReader::SpeedReader(const ReferredMotion& motion, SampleRun run, const PoseNoise& noise,
                         const SharedErrors& errors, PathPart part, double widest_s)
    : shared_(noise.shared),
      errors_(errors),
      part_(part),
      slopes_(motion, run, noise, errors, part),
      widest_s_(widest_s) {}

UncertainValue SpeedReader::greatest(SpeedPoint point, SampleRun run, int way) {
  return Search(*this, point, run, way).greatest();
}

}  // namespace condyle::host
