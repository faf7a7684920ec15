// SPDX-License-Identifier: Apache-2.0
#include "exports/even_times.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hosted/files/input_error.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr double kLargestShift = 0.1;  // of a step
constexpr double kLongStep = 1.5;
constexpr std::size_t kMostFrames = 100'000'000;
constexpr TimeNs kSameTime_ns = 1;  // times are rounded to it

double median_step_s(const std::vector<TimeNs>& time_ns) {
  std::vector<double> steps_s;
  steps_s.reserve(time_ns.size());
  for (std::size_t k = 1; k < time_ns.size(); ++k) {
    steps_s.push_back(difference_s<double>(time_ns[k], time_ns[k - 1]));
  }
  return upper_median(std::move(steps_s));
}

// Time of the first frame, and the step, that fit the samples best.
struct Line {
  double first_s = 0, step_s = 0;
};

Line fit(const std::vector<double>& time_s, const std::vector<std::size_t>& frame_of) {
  const auto count = static_cast<double>(time_s.size());
  double mean_time = 0, mean_frame = 0;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    mean_time += time_s[k] / count;
    mean_frame += static_cast<double>(frame_of[k]) / count;
  }
  double product = 0, square = 0;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    const double frame = static_cast<double>(frame_of[k]) - mean_frame;
    product += frame * (time_s[k] - mean_time);
    square += frame * frame;
  }
  const double step_s = product / square;
  return {mean_time - step_s * mean_frame, step_s};
}

double largest_shift_s(const std::vector<double>& time_s, const std::vector<std::size_t>& frame_of,
                       const Line& line) {
  double largest_s = 0;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    const double even_s = line.first_s + line.step_s * static_cast<double>(frame_of[k]);
    largest_s = std::max(largest_s, std::abs(time_s[k] - even_s));
  }
  return largest_s;
}

// The roundest rate that fits the samples about as well as the best one does.
double round_rate_Hz(const std::vector<double>& time_s, const std::vector<std::size_t>& frame_of,
                     const Line& best) {
  const double allowed_s = 1.5 * largest_shift_s(time_s, frame_of, best) + 2e-9;
  const double rate_Hz = 1 / best.step_s;
  for (double decimals = 1; decimals <= 1e6; decimals *= 10) {
    const double rounded_Hz = std::round(rate_Hz * decimals) / decimals;
    if (rounded_Hz <= 0) continue;
    Line line{0, 1 / rounded_Hz};
    double lowest_s = std::numeric_limits<double>::infinity(), highest_s = -lowest_s;
    for (std::size_t k = 0; k < time_s.size(); ++k) {
      const double rest_s = time_s[k] - line.step_s * static_cast<double>(frame_of[k]);
      lowest_s = std::min(lowest_s, rest_s);
      highest_s = std::max(highest_s, rest_s);
    }
    if ((highest_s - lowest_s) / 2 <= allowed_s) return rounded_Hz;
  }
  return rate_Hz;
}

// The values of `series` at a share of the way from sample `k` to the next.
void interpolate(const ExportSeries& series, std::size_t k, double share, double* to) {
  const std::size_t count = series.components.size();
  const double *a = series.at(k), *b = series.at(k + 1);
  if (series.quantity == "orientation" && count == 4) {
    const Eigen::Quaterniond from(a[0], a[1], a[2], a[3]), into(b[0], b[1], b[2], b[3]);
    const Eigen::Quaterniond between = from.slerp(share, into);
    to[0] = between.w();
    to[1] = between.x();
    to[2] = between.y();
    to[3] = between.z();
    return;
  }
  for (std::size_t i = 0; i < count; ++i) to[i] = a[i] + share * (b[i] - a[i]);
}

}  // namespace

EvenTimes even_times(const ExportData& data) {
  constexpr const char* kMend =
      "give --resample-Hz R, or export to CSV, which keeps the time of each sample";
  EvenTimes even;
  const std::size_t samples = data.samples();
  if (samples == 1) {
    even.rate_Hz = data.rate_Hz.value_or(data.info.stated.rate_Hz.value_or(1));
    even.frame_of = {0};
    even.frames = 1;
    return even;
  }
  const double step_s = data.rate_Hz ? 1 / *data.rate_Hz : median_step_s(data.time_ns);
  std::vector<double> time_s;
  time_s.reserve(samples);
  double frame = 0;
  for (std::size_t k = 0; k < samples; ++k) {
    time_s.push_back(difference_s<double>(data.time_ns[k], data.time_ns[0]));
    if (k > 0) frame += std::max(1.0, std::round((time_s[k] - time_s[k - 1]) / step_s));
    if (frame > static_cast<double>(kMostFrames)) {
      throw InputError(data.source, "has gaps that would be more than 100 million empty frames",
                       "export to CSV, which keeps the time of each sample");
    }
    even.frame_of.push_back(static_cast<std::size_t>(frame));
  }
  even.frames = even.frame_of.back() + 1;
  const Line best = fit(time_s, even.frame_of);
  even.rate_Hz = data.rate_Hz ? *data.rate_Hz : round_rate_Hz(time_s, even.frame_of, best);
  even.largest_shift_s = largest_shift_s(time_s, even.frame_of, {0, 1 / even.rate_Hz});
  const double shift_s = largest_shift_s(time_s, even.frame_of, best);
  if (shift_s > kLargestShift * best.step_s || even.largest_shift_s > best.step_s) {
    throw InputError(
        data.source,
        fmt::format("its times do not follow one rate: at {:.4g} Hz a sample would move by {:.3g} "
                    "ms, and the step is {:.3g} ms",
                    1 / best.step_s, shift_s * 1e3, best.step_s * 1e3),
        kMend);
  }
  return even;
}

void note_even_times(const ExportData& data, const EvenTimes& even, bool keeps_start,
                     std::vector<std::string>& notes) {
  if (even.frames > data.samples()) {
    const std::size_t empty = even.frames - data.samples();
    notes.push_back(fmt::format("{} frame{} without values stand for samples that are not there",
                                empty, empty == 1 ? "" : "s"));
  }
  if (even.largest_shift_s > 1e-6) {
    notes.push_back(
        fmt::format("the format has even times at {:g} Hz: samples moved by up to "
                    "{:.3g} ms",
                    even.rate_Hz, even.largest_shift_s * 1e3));
  }
  if (!keeps_start && data.time_ns[0] != 0) {
    notes.push_back(fmt::format("times begin at 0, which is {:.6f} s of the recording",
                                seconds(data.time_ns[0])));
  }
}

void resample(ExportData& data, double rate_Hz) {
  if (data.samples() < 2) {
    throw InputError(data.source, "has one sample", "leave out --resample-Hz");
  }
  const double long_step_s = kLongStep * median_step_s(data.time_ns);
  const double duration_s = difference_s<double>(data.time_ns.back(), data.time_ns.front());
  const double count = std::floor(duration_s * rate_Hz * (1 + 1e-12)) + 1;
  if (count > static_cast<double>(kMostFrames)) {
    throw InputError("--resample-Hz", fmt::format("would give {:.3g} samples", count),
                     "give a lower rate; 100 million samples are allowed");
  }
  const std::vector<TimeNs> old_ns = std::move(data.time_ns);
  std::vector<ExportSeries> old = std::move(data.series);
  data.time_ns.clear();
  data.series = old;
  for (ExportSeries& series : data.series) series.values.clear();
  std::size_t k = 0, taken = 0;
  for (std::size_t n = 0; n < static_cast<std::size_t>(count); ++n) {
    const TimeNs time_ns = old_ns[0] + nanoseconds(static_cast<double>(n) / rate_Hz);
    while (k + 1 < old_ns.size() && old_ns[k + 1] <= time_ns + kSameTime_ns) ++k;
    data.time_ns.push_back(time_ns);
    const bool is_sample = time_ns - old_ns[k] <= kSameTime_ns && old_ns[k] - time_ns <= 1;
    taken += is_sample ? 1U : 0U;
    const bool has_next = k + 1 < old_ns.size();
    const double step_s = has_next ? difference_s<double>(old_ns[k + 1], old_ns[k]) : 0;
    for (std::size_t i = 0; i < old.size(); ++i) {
      std::vector<double>& values = data.series[i].values;
      const std::size_t size = old[i].components.size();
      if (is_sample) {
        values.insert(values.end(), old[i].at(k), old[i].at(k) + size);
        continue;
      }
      values.resize(values.size() + size, std::numeric_limits<double>::quiet_NaN());
      if (!has_next || step_s > long_step_s || !old[i].is_there(k) || !old[i].is_there(k + 1)) {
        continue;
      }
      const double share = difference_s<double>(time_ns, old_ns[k]) / step_s;
      interpolate(old[i], k, share, values.data() + values.size() - size);
    }
  }
  data.rate_Hz = rate_Hz;
  data.notes.push_back(fmt::format(
      "resampled to {:g} Hz by straight lines between samples, never across a gap; {} of {} times "
      "are those of samples",
      rate_Hz, taken, data.samples()));
  if (const double old_Hz = kLongStep / long_step_s; rate_Hz < 0.999 * old_Hz) {
    data.notes.push_back(
        fmt::format("nothing was filtered before: motion faster than {:g} Hz appears as a slower "
                    "one",
                    rate_Hz / 2));
  }
  if (taken == data.samples()) return;
  for (ExportSeries& series : data.series) {
    if (series.provenance != Provenance::measured) continue;
    series.provenance = Provenance::derived;
    series.assumption = "straight lines between samples";
  }
}

}  // namespace condyle::host
