// SPDX-License-Identifier: Apache-2.0
#include "protocols/head_motion/head_motion_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

constexpr std::size_t kMostSamples = 5'000'000;
constexpr const char* kColumn = "acceleration_m_s2";

RecordingOptions options_of(const HeadMotionSource& source) {
  RecordingOptions options = source.choice.reading;
  options.drive_column = kColumn;
  return options;
}

// Times since the recording's first sample; those of the acceleration minus its delay.
class Reader {
 public:
  Reader(const HeadMotionSource& source, IdentifiedHeadMotion& motion)
      : source_(source), motion_(motion) {}

  void read() {
    const bool is_apart = !source_.acceleration.empty();
    read_positions(is_apart);
    if (is_apart) read_acceleration();
  }

 private:
  void read_positions(bool is_apart) {
    const auto recording = open_recording(source_.recording, options_of(source_));
    const RecordingInfo& info = recording->info();
    source_.choice.check(source_.recording, info);
    // The drive of a device is a force, not an acceleration.
    const bool has_acceleration = info.has_drive && !info.is_of_device;
    if (is_apart == has_acceleration) {
      throw InputError(source_.recording,
                       is_apart ? "has an acceleration of its own" : "has no acceleration",
                       is_apart ? "leave out --acceleration, or its column with --ignore-column "
                                  "acceleration_m_s2"
                                : "give it with --acceleration FILE");
    }
    FollowedPositions positions(source_.choice);
    Sample sample;
    while (recording->next(sample)) {
      if (!sample.time_valid) continue;
      if (!first_ns_) first_ns_ = sample.time_ns;
      if (has_acceleration && sample.drive_valid) add(*recording, sample, sample.drive_N);
      const std::optional<double> position_m = positions.position_m(sample);
      if (!position_m) continue;
      const double time_s = seconds(sample.time_ns - *first_ns_);
      if (time_s < source_.begin_s.value_or(time_s) || time_s > source_.end_s.value_or(time_s)) {
        continue;
      }
      append(*recording, time_s, *position_m, motion_.time_s, motion_.position_m);
    }
  }

  void read_acceleration() {
    RecordingOptions options;  // the other options apply to RECORDING
    options.faults = source_.choice.reading.faults;
    options.drive_column = kColumn;
    options.reads_drive_alone = true;
    const auto recording = open_recording(source_.acceleration, options);
    Sample sample;
    while (recording->next(sample)) {
      if (sample.time_valid && sample.drive_valid) add(*recording, sample, sample.drive_N);
    }
  }

  void add(const Recording& recording, const Sample& sample, double acceleration_m_s2) {
    const double time_s = seconds(sample.time_ns - first_ns_.value_or(0)) - source_.delay_s;
    if (time_s < source_.begin_s.value_or(time_s) - motion_.parameters.longest_gap_s ||
        time_s > source_.end_s.value_or(time_s) + motion_.parameters.longest_gap_s) {
      return;
    }
    append(recording, time_s, acceleration_m_s2, motion_.acceleration_time_s,
           motion_.acceleration_m_s2);
  }

  static void append(const Recording& recording, double time_s, double value,
                     std::vector<double>& times_s, std::vector<double>& values) {
    if (!times_s.empty() && !(time_s > times_s.back())) {
      throw InputError(recording.place(), "time does not increase",
                       "leave out repeated and reversed rows");
    }
    if (times_s.size() == kMostSamples) {
      throw InputError(recording.place(), fmt::format("more than {} samples", kMostSamples),
                       "choose a part with --begin-s and --end-s");
    }
    times_s.push_back(time_s);
    values.push_back(value);
  }

  const HeadMotionSource& source_;
  IdentifiedHeadMotion& motion_;
  std::optional<TimeNs> first_ns_;
};

// Whether a position has accelerations before and after it, within the longest gap.
std::size_t count_taken(const IdentifiedHeadMotion& motion) {
  const auto& times_s = motion.acceleration_time_s;
  return static_cast<std::size_t>(
      std::count_if(motion.time_s.begin(), motion.time_s.end(), [&](double time_s) {
        const auto after = std::lower_bound(times_s.begin(), times_s.end(), time_s);
        return after != times_s.end() &&
               (*after == time_s || (after != times_s.begin() &&
                                     *after - *(after - 1) <= motion.parameters.longest_gap_s));
      }));
}

void run(IdentifiedHeadMotion& motion) {
  HeadMotionIdentification<double> identification(motion.parameters);
  const auto& times_s = motion.acceleration_time_s;
  std::size_t next = 0;  // acceleration
  double concluded_s = -1;
  const auto add_next = [&] {
    identification.add_acceleration(nanoseconds(times_s[next]), motion.acceleration_m_s2[next]);
    ++next;
  };
  for (std::size_t i = 0; i < motion.time_s.size(); ++i) {
    const double time_s = motion.time_s[i];
    while (next < times_s.size() && times_s[next] <= time_s) add_next();
    identification.add_position(nanoseconds(time_s), motion.position_m[i]);
    if (time_s - concluded_s < 1) continue;
    concluded_s = time_s;
    const auto now = identification.estimate();
    if (!std::isfinite(now.damping_rate_per_s.fitted_sd) ||
        !std::isfinite(now.stiffness_per_mass_per_s2.fitted_sd)) {
      continue;
    }
    motion.course.push_back({time_s, now.damping_rate_per_s.fitted,
                             now.damping_rate_per_s.fitted_sd, now.stiffness_per_mass_per_s2.fitted,
                             now.stiffness_per_mass_per_s2.fitted_sd});
  }
  while (next < times_s.size()) add_next();
  identification.conclude();
  motion.estimate = identification.estimate();
  motion.counts = identification.counts();
}

}  // namespace

IdentifiedHeadMotion identify_head_motion(const HeadMotionSource& source,
                                          const HeadMotionParameters& parameters) {
  if (source.begin_s && source.end_s && !(*source.end_s > *source.begin_s)) {
    throw InputError(
        "--end-s",
        fmt::format("{:g} s is not after the start at {:g} s", *source.end_s, *source.begin_s),
        "give a later time");
  }
  IdentifiedHeadMotion motion;
  motion.recording = source.recording;
  motion.parameters = parameters;
  Reader(source, motion).read();
  motion.stated_noise_sd_m = source.noise_sd_m;
  motion.stated_acceleration_noise_sd_m_s2 = source.acceleration_noise_sd_m_s2;
  motion.taken = count_taken(motion);
  if (motion.taken == 0) {
    throw InputError(source.recording,
                     "none of its positions has accelerations before and after it",
                     "check that both use the same clock, and check --begin-s and --end-s");
  }
  run(motion);
  return motion;
}

}  // namespace condyle::host
