// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "condyle/firmware/run_loop.h"
#include "condyle/hal/clock.h"
#include "condyle/hal/facebow.h"
#include "recordings/recording.h"

namespace condyle::host {

/// The median of the steps between `times_ns` that go forward; absent if none does.
std::optional<TimeNs> median_step_ns(const std::vector<TimeNs>& times_ns);

/// A recording behind the facebow interface. Bad reports and disconnections of a recorded device
/// occur as they did live. After a disconnection, opening continues behind it, otherwise at the
/// start.
class ReplayFacebow final : public hal::Facebow {
 public:
  /// Samples read at opening, to find the recording's median step in bounded memory.
  static constexpr std::size_t kLookAhead = 65536;

  /// `speed`: 0 as fast as possible, 1 real time, 2 twice as fast ...
  ReplayFacebow(std::string path, RecordingOptions options, double speed, hal::Clock& clock);

  hal::Status open() override;
  hal::Status read(TimeNs deadline_ns, Sample& sample) override;
  void close() override;
  /// read(), but skips the bad reports of a recorded device.
  hal::Status read_past_bad_reports(TimeNs deadline_ns, Sample& sample);

  /// The problem of the recording; empty if there is none.
  const std::string& problem() const { return problem_; }
  /// Properties of the recording; only while open.
  const RecordingInfo& info() const { return recording_->info(); }
  /// Time between samples as the recording states it, else the median (of the first kLookAhead);
  /// absent if all times are equal.
  std::optional<TimeNs> median_step_ns() const { return median_step_ns_; }
  /// Time between samples for finding gaps: the live one for a device's recording, otherwise the
  /// median step; 0 if it is not known.
  TimeNs expected_step_ns() const {
    return (info().is_of_device ? info().nominal_step_ns : median_step_ns_).value_or(0);
  }
  /// Settings for the run loop.
  firmware::RunSettings run_settings(FollowedCoordinate followed) const;
  /// Share of the recording read so far, 0 to 1.
  double progress() const { return recording_ ? recording_->progress() : 0; }

 private:
  // An item of the recording: a sample, or a number of other events.
  struct Arrival {
    hal::Status status = hal::Status::ok;
    Sample sample;
    std::uint64_t times = 1;
  };

  bool fetch();
  void find_median_step();

  std::string path_;
  RecordingOptions options_;
  double speed_;
  hal::Clock& clock_;
  std::unique_ptr<Recording> recording_;
  std::deque<Arrival> ahead_;
  bool is_away_ = false;  // disconnected was returned
  std::optional<TimeNs> median_step_ns_;
  std::optional<TimeNs> previous_time_ns_;
  // Replay's time zero, on the clock and in the recording.
  std::optional<TimeNs> start_ns_, first_time_ns_;
  std::string problem_;
};

}  // namespace condyle::host
