// SPDX-License-Identifier: Apache-2.0
#include "sample_gate.h"

#include <fmt/format.h>

#include <cmath>

#include "condyle.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"

namespace condyle::host {

void SampleGate::refuse(const char* field, const std::string& problem) const {
  throw InputError(fmt::format("sample {} (the first is 0): {}", count_, field), problem,
                   "leave the sample out, or count it as an event with --faults=event");
}

void SampleGate::take_time(const GivenSample& given, Sample& sample) const {
  if (given.time_s) {
    sample.time_valid = std::abs(*given.time_s) <= kFurthestTime_s;  // false for NaN
    if (sample.time_valid) sample.time_ns = nanoseconds(*given.time_s);
  } else {
    constexpr TimeNs kFurthest_ns = static_cast<TimeNs>(kFurthestTime_s) * kNanosecondsPerSecond;
    sample.time_valid = given.time_ns >= -kFurthest_ns && given.time_ns <= kFurthest_ns;
    if (sample.time_valid) sample.time_ns = given.time_ns;
  }
  if (!refuses()) return;
  if (!sample.time_valid) {
    const bool is_missing =
        given.time_s ? std::isnan(*given.time_s) : given.time_ns == CONDYLE_NO_TIME;
    refuse("time", is_missing ? "is missing"
                              : fmt::format("is not within {:.2g} s of zero", kFurthestTime_s));
  }
  if (last_ns_ && sample.time_ns < *last_ns_) {
    refuse("time", fmt::format("runs backwards, from {:.9g} s to {:.9g} s", seconds(*last_ns_),
                               seconds(sample.time_ns)));
  }
}

void SampleGate::take_position(const double* position, Sample& sample) const {
  const std::size_t count = coordinate_count(kind_);
  for (std::size_t i = 0; i < count; ++i) {
    sample.coordinates[i] = position[i];
    sample.position_valid = sample.position_valid && std::isfinite(position[i]);
    if (refuses() && std::isinf(position[i])) {
      refuse("position", fmt::format("coordinate {} is infinite", i));
    }
  }
  sample.position_valid = sample.position_valid && !is_out_of_range(kind_, sample.coordinates);
}

void SampleGate::take_drive(double drive_N, Sample& sample) const {
  if (!has_drive_) {
    if (std::isnan(drive_N)) return;
    throw InputError(fmt::format("sample {} (the first is 0): drive", count_),
                     "is given, but the estimator was made without a drive",
                     "make it with one, or give NaN");
  }
  if (refuses() && std::isinf(drive_N)) refuse("drive", "is infinite");
  sample.drive_valid = std::isfinite(drive_N);
  if (sample.drive_valid) sample.drive_N = drive_N;
}

Sample SampleGate::next(const GivenSample& given) {
  Sample sample;
  sample.kind = kind_;
  sample.sequence = count_;
  take_time(given, sample);
  take_position(given.position, sample);
  take_drive(given.drive_N, sample);
  if (sample.time_valid) last_ns_ = sample.time_ns;
  ++count_;
  return sample;
}

}  // namespace condyle::host
