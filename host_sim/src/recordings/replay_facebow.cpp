// SPDX-License-Identifier: Apache-2.0
#include "recordings/replay_facebow.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "hosted/files/input_error.h"
#include "recordings/recording_files.h"
#include "statistics/quantile.h"

namespace condyle::host {

std::optional<TimeNs> median_step_ns(const std::vector<TimeNs>& times_ns) {
  std::vector<TimeNs> steps;
  for (std::size_t i = 1; i < times_ns.size(); ++i) {
    if (times_ns[i] > times_ns[i - 1]) steps.push_back(times_ns[i] - times_ns[i - 1]);
  }
  if (steps.empty()) return std::nullopt;
  return upper_median(std::move(steps));
}

ReplayFacebow::ReplayFacebow(std::string path, RecordingOptions options, double speed,
                             hal::Clock& clock)
    : path_(std::move(path)), options_(std::move(options)), speed_(speed), clock_(clock) {}

hal::Status ReplayFacebow::open() {
  if (std::exchange(is_away_, false)) return hal::Status::ok;
  close();
  problem_.clear();
  try {
    recording_ = open_recording(path_, options_);
    std::size_t samples = 0;
    while (samples < kLookAhead && fetch()) {
      if (ahead_.back().status == hal::Status::ok) ++samples;
    }
    if (samples == 0) {
      throw InputError(path_, "has no samples", "give a recording with at least one row");
    }
  } catch (const InputError& error) {
    close();
    problem_ = error.what();
    const std::vector<std::string> files = recording_files(path_);
    const auto lacks = [&files](int access_mode) {
      return std::any_of(files.begin(), files.end(), [access_mode](const std::string& file) {
        return access(file.c_str(), access_mode) != 0;
      });
    };
    if (lacks(F_OK)) return hal::Status::not_found;
    return lacks(R_OK) ? hal::Status::not_permitted : hal::Status::bad_report;
  }
  find_median_step();
  return hal::Status::ok;
}

// False at the end.
bool ReplayFacebow::fetch() {
  Arrival arrival;
  Sample& sample = arrival.sample;
  arrival.status = recording_->read(sample);
  if (arrival.status == hal::Status::end) return false;
  if (arrival.status != hal::Status::ok) {
    if (!ahead_.empty() && ahead_.back().status == arrival.status) {
      ++ahead_.back().times;
    } else {
      ahead_.push_back(arrival);
    }
    return true;
  }
  if (sample.time_valid) {
    if (previous_time_ns_ && sample.time_ns < *previous_time_ns_ &&
        options_.faults == FaultPolicy::refuse) {
      throw InputError(recording_->place() + ": time",
                       fmt::format("runs backwards, from {:.9g} s to {:.9g} s",
                                   seconds(*previous_time_ns_), seconds(sample.time_ns)),
                       "sort the rows, or count them as events with --faults event");
    }
    previous_time_ns_ = sample.time_ns;
  }
  ahead_.push_back(arrival);
  return true;
}

void ReplayFacebow::find_median_step() {
  median_step_ns_ = info().nominal_step_ns;
  if (median_step_ns_) return;
  std::vector<TimeNs> times_ns;
  for (const auto& [status, sample, times] : ahead_) {
    if (status == hal::Status::ok && sample.time_valid) times_ns.push_back(sample.time_ns);
  }
  median_step_ns_ = host::median_step_ns(times_ns);
}

hal::Status ReplayFacebow::read(TimeNs deadline_ns, Sample& sample) {
  if (!recording_ || is_away_) return hal::Status::not_open;
  if (!problem_.empty()) return hal::Status::end;
  if (ahead_.empty()) {
    try {
      if (!fetch()) return hal::Status::end;
    } catch (const InputError& error) {
      problem_ = error.what();
      return hal::Status::bad_report;
    }
  }
  Arrival& arrival = ahead_.front();
  if (const hal::Status status = arrival.status; status != hal::Status::ok) {
    if (--arrival.times == 0) ahead_.pop_front();
    is_away_ = status == hal::Status::disconnected;
    return status;
  }
  const Sample& due = arrival.sample;
  if (speed_ > 0 && due.time_valid) {
    if (!start_ns_) {
      start_ns_ = clock_.now_ns();
      first_time_ns_ = due.time_ns;
    }
    const double wait_ns = static_cast<double>(due.time_ns - *first_time_ns_) / speed_;
    const double deadline_wait_ns = static_cast<double>(deadline_ns - *start_ns_);
    if (wait_ns > deadline_wait_ns) {
      clock_.sleep_until(deadline_ns);
      return hal::Status::timeout;
    }
    if (wait_ns > 0) clock_.sleep_until(*start_ns_ + static_cast<TimeNs>(wait_ns));
  }
  sample = due;
  ahead_.pop_front();
  return hal::Status::ok;
}

firmware::RunSettings ReplayFacebow::run_settings(FollowedCoordinate followed) const {
  firmware::RunSettings settings;
  settings.followed = followed;
  settings.expects_drive = info().has_drive;
  settings.nominal_step_ns = expected_step_ns();
  settings.reopen_pause_ns = 1;  // it reconnects at once
  return settings;
}

hal::Status ReplayFacebow::read_past_bad_reports(TimeNs deadline_ns, Sample& sample) {
  hal::Status status = read(deadline_ns, sample);
  while (status == hal::Status::bad_report && problem_.empty()) {
    status = read(deadline_ns, sample);
  }
  return status;
}

void ReplayFacebow::close() {
  recording_.reset();
  is_away_ = false;
  ahead_.clear();
  previous_time_ns_.reset();
  start_ns_.reset();
  first_time_ns_.reset();
}

}  // namespace condyle::host
