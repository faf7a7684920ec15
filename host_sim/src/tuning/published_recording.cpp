// SPDX-License-Identifier: Apache-2.0
#include "tuning/published_recording.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/firmware/run_loop.h"
#include "condyle/hal/clock.h"
#include "hosted/files/input_error.h"
#include "recordings/replay_facebow.h"

namespace condyle::host {
namespace {

// Collects the positions that a PublishedSensor would pass to its cascade.
class PositionKeeper {
 public:
  struct Estimate {
    EventSet events;
  };

  PositionKeeper(FollowedCoordinate followed, std::vector<double>& position_m)
      : followed_(followed), position_m_(position_m) {}

  Estimate process(const Sample& sample, EventSet events) {
    if (events.has(Event::time_reversed)) return {events};
    position_m_.push_back(published_measurement_m(sample, events, followed_)
                              .value_or(std::numeric_limits<double>::quiet_NaN()));
    return {events};
  }
  bool drain(Estimate&) { return false; }

 private:
  FollowedCoordinate followed_;
  std::vector<double>& position_m_;
};

}  // namespace

PublishedRecording read_for_published(const std::string& path, const RecordingChoice& choice,
                                      std::optional<double> sample_time_s, std::size_t most_samples,
                                      const std::function<void(double)>& show,
                                      const std::function<bool()>& should_stop) {
  hal::SteadyClock clock;
  ReplayFacebow facebow(path, choice.reading, 0, clock);
  if (facebow.open() != hal::Status::ok) throw InputError(facebow.problem());
  choice.check(path, facebow.info());
  if (!sample_time_s && !facebow.median_step_ns()) {
    throw InputError(path, "no time passes between its samples",
                     "give sample_time_s with --parameters");
  }
  PublishedRecording recording;
  recording.name = path;
  recording.sample_time_s = sample_time_s ? *sample_time_s : seconds(*facebow.median_step_ns());
  firmware::RunSettings settings = facebow.run_settings(choice.followed);
  settings.expects_drive = false;  // not used
  settings.nominal_step_ns = 0;    // no search for gaps
  PositionKeeper keeper(choice.followed, recording.position_m);
  firmware::RunCounts counts;
  (void)firmware::run(
      facebow, clock, keeper, settings, counts,
      [&](const Sample&, const PositionKeeper::Estimate&) {
        const double kept = static_cast<double>(recording.position_m.size());
        show(std::max(facebow.progress(), kept / static_cast<double>(most_samples)));
      },
      [&] {
        return should_stop() || !facebow.problem().empty() ||
               recording.position_m.size() >= most_samples;
      });
  if (!facebow.problem().empty()) throw InputError(facebow.problem());
  if (recording.position_m.size() >= most_samples) {
    Sample more;
    const hal::Status status = facebow.read_past_bad_reports(clock.now_ns(), more);
    recording.is_cut = status == hal::Status::ok || status == hal::Status::disconnected;
  }
  return recording;
}

}  // namespace condyle::host
