// SPDX-License-Identifier: Apache-2.0
#include "protocols/release/release_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hosted/files/input_error.h"
#include "quality/sixth_differences.h"

namespace condyle::host {
namespace {

void read_all(const ReleaseSource& source, ReleaseStretch& stretch) {
  const auto recording = open_recording(source.recording, source.choice.reading);
  source.choice.check(source.recording, recording->info());
  FollowedPositions positions(source.choice);
  Sample sample;
  std::optional<TimeNs> first_ns;
  while (recording->next(sample)) {
    const std::optional<double> position_m = positions.position_m(sample);
    if (!sample.time_valid || !position_m) continue;
    if (!first_ns) first_ns = sample.time_ns;
    const double time_s = seconds(sample.time_ns - *first_ns);
    if (!stretch.all_time_s.empty() && !(time_s > stretch.all_time_s.back())) {
      throw InputError(recording->place(), "time does not increase",
                       "leave out repeated and reversed rows");
    }
    if (stretch.all_time_s.size() == kMostReleaseSamples) {
      throw InputError(source.recording,
                       fmt::format("has more than {} samples", kMostReleaseSamples),
                       "cut out the part with the release");
    }
    stretch.all_time_s.push_back(time_s);
    stretch.all_position_m.push_back(*position_m);
  }
}

double find_begin_s(const ReleaseSource& source, const ReleaseStretch& stretch) {
  const auto begins = find_motion_begins(stretch.all_time_s, stretch.all_position_m);
  if (begins.size() == 1) return stretch.all_time_s[begins[0]];
  if (begins.empty()) {
    throw InputError(
        source.recording,
        "no motion begins after 0.15 s at rest, so the time of the release is not known",
        "give --begin-s, the time of the release (s from the first sample)");
  }
  std::string times;
  for (std::size_t i = 0; i < std::min<std::size_t>(begins.size(), 8); ++i) {
    times += fmt::format("{}{:.3f}", i > 0 ? ", " : "", stretch.all_time_s[begins[i]]);
  }
  throw InputError(source.recording,
                   fmt::format("{} motions begin after a rest, at {}{} s", begins.size(), times,
                               begins.size() > 8 ? " ..." : ""),
                   "choose the release with --begin-s");
}

}  // namespace

std::vector<std::size_t> find_motion_begins(const std::vector<double>& time_s,
                                            const std::vector<double>& position_m) {
  constexpr double kStill_s = 0.145 /* 0.15 but for rounding */, kShare = 0.03, kNoises = 8;
  constexpr double kLeft =
      1.5;  // factor: motion within the limit of rest does not count as leaving it
  constexpr std::size_t kFewest = 5, kSlowStart = 4;
  std::vector<std::size_t> begins;
  if (position_m.size() < 2 * kFewest) return begins;
  const auto [low, high] = std::minmax_element(position_m.begin(), position_m.end());
  const double limit_m =
      std::max(kShare * (*high - *low), kNoises * noise_by_sixth_differences(position_m));
  // True if a part at rest ends before `end`, and samples i and i + 1 have left it.
  const auto leaves = [&](std::size_t i, std::size_t end) {
    std::size_t first = end;
    while (first > 0 && time_s[end - 1] - time_s[first] < kStill_s) --first;
    if (end - first < kFewest || time_s[end - 1] - time_s[first] < kStill_s) return false;
    const auto from = position_m.begin() + static_cast<std::ptrdiff_t>(first);
    const auto to = position_m.begin() + static_cast<std::ptrdiff_t>(end);
    const auto [least, most] = std::minmax_element(from, to);
    if (*most - *least > limit_m) return false;
    const double mean_m = std::accumulate(from, to, 0.0) / static_cast<double>(end - first);
    const double now_m = position_m[i] - mean_m, next_m = position_m[i + 1] - mean_m;
    return std::min(std::abs(now_m), std::abs(next_m)) > kLeft * limit_m && now_m * next_m > 0;
  };
  // A slow start leaves the rest within a few samples.
  for (std::size_t i = kFewest; i + 1 < position_m.size(); ++i) {
    if (!begins.empty() && i <= begins.back() + kSlowStart) continue;
    for (std::size_t end = i; end >= kFewest && end + kSlowStart > i; --end) {
      if (!leaves(i, end)) continue;
      begins.push_back(i);
      break;
    }
  }
  return begins;
}

ReleaseStretch read_release(const ReleaseSource& source) {
  ReleaseStretch stretch;
  read_all(source, stretch);
  if (stretch.all_time_s.empty()) {
    throw InputError(source.recording, "contains no position", "record the release again");
  }
  stretch.was_found = !source.begin_s;
  const double let_go_s = source.begin_s ? *source.begin_s : find_begin_s(source, stretch);
  const double end_s = source.end_s.value_or(let_go_s + kReleaseDuration_s);
  const double begin_s = let_go_s + source.let_go_s;
  if (!(end_s > begin_s)) {
    throw InputError("--end-s",
                     fmt::format("{:g} s is not after the start at {:g} s", end_s, begin_s),
                     "give a later time");
  }
  for (std::size_t i = 0; i < stretch.all_time_s.size(); ++i) {
    const double time_s = stretch.all_time_s[i];
    if (time_s < begin_s - 1e-9 || time_s > end_s + 1e-9) continue;
    stretch.time_s.push_back(time_s);
    stretch.position_m.push_back(stretch.all_position_m[i]);
  }
  return stretch;
}

}  // namespace condyle::host
