// SPDX-License-Identifier: Apache-2.0
// The loop from a facebow through an estimator to a sink. Replay, measurement box and bare metal
// run this one. No heap, no exceptions; the clock is given.
#pragma once

#include "condyle/estimator/events.h"
#include "condyle/estimator/sample.h"
#include "condyle/hal/clock.h"
#include "condyle/hal/facebow.h"

namespace condyle::firmware {

/// What the loop follows and expects.
struct RunSettings {
  FollowedCoordinate followed;
  TimeNs nominal_step_ns = 0;        ///< for finding gaps; 0 finds none
  bool expects_drive = false;        ///< a sample without drive force is an event
  TimeNs patience_ns = 100'000'000;  ///< longest wait for a sample before looking at `should_stop`
};

/// What happened in a run.
struct RunCounts {
  std::uint64_t samples = 0;  ///< read from the facebow
  std::uint64_t timeouts = 0;
  std::uint64_t bad_reports = 0;
  EventCounts events;
};

/// One sample through `estimator`: its estimate with the sample's events added. A sample whose time
/// runs backwards is kept from the estimator; one without a usable position lets it predict only.
template <class Estimator>
typename Estimator::Estimate process_sample(const Sample& sample, EventSet sample_events,
                                            FollowedCoordinate followed, Estimator& estimator) {
  using Scalar = decltype(Estimator::Estimate::kNone);
  typename Estimator::Estimate estimate;
  if (!sample_events.has(Event::time_reversed)) {
    const bool usable = sample.position_valid && !sample_events.has(Event::zero_filled) &&
                        is_available(sample.kind, followed);
    estimate = usable ? estimator.step(static_cast<Scalar>(followed_position_m(sample, followed)))
                      : estimator.step_without_measurement();
    estimate.events.add(Event::position_missing, !is_available(sample.kind, followed));
  }
  estimate.events.add(sample_events);
  return estimate;
}

/// Reads `facebow` (which is open, on `clock`) and gives each sample with its estimate to
/// `sink(sample, estimate)`, until the facebow ends or `should_stop()`. Returns why it stopped:
/// `ok` where it was told to, else the facebow's last status. Timeouts and bad reports are counted.
template <class Estimator, class Sink, class Predicate>
hal::Status run(hal::Facebow& facebow, hal::Clock& clock, Estimator& estimator,
                const RunSettings& settings, RunCounts& counts, Sink&& sink,
                Predicate&& should_stop) {
  SampleChecker checker(settings.nominal_step_ns, settings.expects_drive, settings.followed);
  while (!should_stop()) {
    Sample sample;
    const hal::Status status = facebow.read(clock.now_ns() + settings.patience_ns, sample);
    switch (status) {
      case hal::Status::ok: {
        ++counts.samples;
        const auto estimate =
            process_sample(sample, checker.check(sample), settings.followed, estimator);
        counts.events.add(estimate.events);
        sink(sample, estimate);
        break;
      }
      case hal::Status::timeout:
        ++counts.timeouts;
        break;
      case hal::Status::bad_report:
        ++counts.bad_reports;
        break;
      default:
        return status;
    }
  }
  return hal::Status::ok;
}

}  // namespace condyle::firmware
