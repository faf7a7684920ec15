// SPDX-License-Identifier: Apache-2.0
#include "tuning/tuning_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "condyle/estimator/math/innovation_monitor.h"
#include "condyle/firmware/run_loop.h"
#include "condyle/firmware/sensor_choice.h"
#include "condyle/hal/clock.h"
#include "estimation/estimator_choice.h"
#include "hosted/files/input_error.h"
#include "recordings/replay_facebow.h"
#include "tuning/innovation_likelihood.h"

namespace condyle::host {
namespace {

// With this lag, the adaptive estimator can use the next samples to judge a sample.
constexpr int kHindsight = 8;

// Converts estimates to samples.
class SampleCollector {
 public:
  SampleCollector(StretchKeeper& keeper, TuningRecording& recording)
      : keeper_(keeper), recording_(recording) {}

  void add(const RecommendedEstimate<double>& estimate, int axis) {
    if (!estimate.is_ready || !estimate.time_valid || estimate.events.has(Event::time_reversed)) {
      return;
    }
    const AxisEstimate<double>& seen = estimate.axes[axis];
    TuningSample sample;
    const bool is_lost = estimate.events.has(Event::state_lost);
    const bool begins = !has_time_ || estimate.events.has(Event::time_restarted) ||
                        estimate.events.has(Event::state_restarted) || was_lost_ || is_lost;
    sample.step_s = begins ? 0 : seconds(estimate.time_ns - time_ns_);
    if (!begins && !(sample.step_s > 0)) return;  // a repeated sample
    time_ns_ = estimate.time_ns;
    has_time_ = true;
    was_lost_ = is_lost;
    lowest_m_ = std::fmin(lowest_m_, seen.measured_position_m);
    highest_m_ = std::fmax(highest_m_, seen.measured_position_m);
    const bool rejected = estimate.events.has(Event::outlier_rejected);
    if (rejected) ++recording_.rejected;
    const bool taken = !rejected && !is_lost && !estimate.events.has(Event::position_frozen) &&
                       std::isfinite(seen.measured_position_m);
    double standardised = std::numeric_limits<double>::quiet_NaN();
    if (taken) {
      sample.position_m = seen.measured_position_m;
      const Innovation innovation{seen.innovation_m, seen.innovation_sd_m * seen.innovation_sd_m};
      standardised = innovation.standardised();
      sample.adaptive_score = innovation.score();
    }
    monitor_.add(standardised, sample.position_m, sample.step_s);
    keeper_.add(sample);
  }

  const InnovationMonitor<double>& monitor() const { return monitor_; }
  /// True if two positions that differ were measured.
  bool has_moved() const { return highest_m_ > lowest_m_; }

 private:
  StretchKeeper& keeper_;
  TuningRecording& recording_;
  InnovationMonitor<double> monitor_;
  bool has_time_ = false, was_lost_ = false;
  TimeNs time_ns_ = 0;
  double lowest_m_ = std::numeric_limits<double>::quiet_NaN();
  double highest_m_ = std::numeric_limits<double>::quiet_NaN();
};

void collect(ReplayFacebow& facebow, hal::Clock& clock, const TuningInput& input,
             const std::string& path, SampleCollector& collector,
             const std::function<void(double)>& show, const std::function<bool()>& should_stop) {
  firmware::RunSettings settings = facebow.run_settings(input.choice.followed);
  settings.expects_drive = false;  // not used
  RecommendedParameters parameters = input.parameters;
  parameters.noise.adaptation = Adaptation::on;
  refuse_long_step(parameters, seconds(settings.nominal_step_ns), path, "its median step",
                   kCheckTimes);
  firmware::with_axes(facebow.info().kind, input.choice.followed.axis, [&](auto axes, int axis) {
    RecommendedSensor<double, decltype(axes)::value> sensor(parameters, kHindsight,
                                                            input.choice.point());
    firmware::RunCounts counts;
    (void)firmware::run(
        facebow, clock, sensor, settings, counts,
        [&](const Sample&, const RecommendedEstimate<double>& estimate) {
          collector.add(estimate, axis);
          show(facebow.progress());
        },
        [&] { return should_stop() || !facebow.problem().empty(); });
  });
  if (!facebow.problem().empty()) throw InputError(facebow.problem());
}

// Refuses recordings that are unusable for learning.
void check_positions(const TuningRecording& recording, SampleKind kind, bool has_moved,
                     const std::string& path) {
  const std::string other =
      kind == SampleKind::one_axis ? "" : "follow another axis (--axis) or point (--point), or ";
  if (recording.seen >= kFewestTuned && !has_moved) {
    throw InputError(path,
                     "its position along the followed axis is always missing, or never changes, so "
                     "it contains neither noise nor motion for tuning",
                     other + "record a jaw that moves");
  }
  if (recording.innovations < kFewestTuned) {
    throw InputError(
        path,
        fmt::format("has {} usable positions along the followed axis, of {} samples, "
                    "and {} in runs long enough for learning; tuning needs {}",
                    recording.usable, recording.seen, recording.innovations, kFewestTuned),
        other + "record longer");
  }
}

}  // namespace

void StretchKeeper::add(TuningSample sample) {
  const std::uint64_t index = seen_++;
  if (index / kStretch % stride_ != 0) return;
  if (samples_.size() == most_) {
    thin();
    if (index / kStretch % stride_ != 0) return;
  }
  if (stride_ > 1 && index % kStretch == 0) sample.step_s = 0;
  samples_.push_back(sample);
}

void StretchKeeper::thin() {
  stride_ *= 2;
  std::size_t kept = 0;
  for (std::size_t begin = 0; begin < samples_.size(); begin += 2 * kStretch) {
    const std::size_t end = std::min(begin + kStretch, samples_.size());
    samples_[begin].step_s = 0;
    for (std::size_t i = begin; i < end; ++i) samples_[kept++] = samples_[i];
  }
  samples_.resize(kept);
}

TuningRecording read_for_tuning(const std::string& path, const TuningInput& input,
                                const std::function<void(double)>& show,
                                const std::function<bool()>& should_stop) {
  hal::SteadyClock clock;
  ReplayFacebow facebow(path, input.choice.reading, 0, clock);
  if (facebow.open() != hal::Status::ok) throw InputError(facebow.problem());
  const RecordingInfo& info = facebow.info();
  input.choice.check(path, info);
  if (!facebow.median_step_ns()) {
    throw InputError(path, "no time passes between its samples", "check its times");
  }
  TuningRecording recording;
  recording.name = path;
  recording.format = info.format;
  recording.notes = info.notes;
  recording.median_step_s = seconds(*facebow.median_step_ns());
  StretchKeeper keeper(input.most_samples);
  SampleCollector collector(keeper, recording);
  collect(facebow, clock, input, path, collector, show, should_stop);
  recording.seen = keeper.seen();
  recording.samples = keeper.take();
  recording.usable = static_cast<std::size_t>(
      std::count_if(recording.samples.begin(), recording.samples.end(),
                    [](const TuningSample& sample) { return std::isfinite(sample.position_m); }));
  // Their number does not depend on the model.
  for_each_innovation(recording.samples, NoiseModel{1e-4, 10, 0}, input.parameters.prior,
                      [&](std::size_t, const Innovation&) { ++recording.innovations; });
  recording.filtered_lag = collector.monitor().filtered_lag();
  recording.neighbours = collector.monitor().noise_correlation(1);
  if (!should_stop()) check_positions(recording, info.kind, collector.has_moved(), path);
  return recording;
}

}  // namespace condyle::host
