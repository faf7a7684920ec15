// SPDX-License-Identifier: Apache-2.0
// The loop from a facebow through a virtual sensor to a sink, for replay, measurement box and bare
// metal. No heap, no exceptions; the clock is passed in.
//
// A virtual sensor has `Estimate` with `events`; `process(sample, events)`, which returns an
// estimate per sample; and `drain(estimate)`, called after the last sample, which returns the
// estimates that waited for later samples.
#pragma once

#include "condyle/estimator/events.h"
#include "condyle/estimator/sample.h"
#include "condyle/hal/clock.h"
#include "condyle/hal/facebow.h"

namespace condyle::firmware {

/// Settings of the loop.
struct RunSettings {
  FollowedCoordinate followed;       ///< the point whose zeros are detected
  TimeNs nominal_step_ns = 0;        ///< for finding gaps; 0 finds none
  bool expects_drive = false;        ///< a sample without drive force is an event
  TimeNs patience_ns = 100'000'000;  ///< longest wait for a sample before looking at `should_stop`
  TimeNs reopen_pause_ns = 0;  ///< between attempts to reopen a facebow that went away; 0: none
};

/// What happened in a run.
struct RunCounts {
  std::uint64_t samples = 0;  ///< read from the facebow
  std::uint64_t timeouts = 0;
  std::uint64_t bad_reports = 0;
  std::uint64_t disconnections = 0;
  EventCounts events;
};

/// Reads `facebow` (which is open, on `clock`) and passes each sample with its estimate to
/// `sink(sample, estimate)`, until the facebow ends or `should_stop()`; then passes the estimates
/// that waited, with the last sample. Returns `ok` if it was stopped, else the facebow's last
/// status. Timeouts, bad reports and disconnections are counted. After a disconnection the facebow
/// is reopened if `settings` ask for it.
template <class Sensor, class Sink, class Predicate>
hal::Status run(hal::Facebow& facebow, hal::Clock& clock, Sensor& sensor,
                const RunSettings& settings, RunCounts& counts, Sink&& sink,
                Predicate&& should_stop) {
  SampleChecker checker(settings.nominal_step_ns, settings.expects_drive, settings.followed);
  Sample sample;
  hal::Status status = hal::Status::ok;
  while (!should_stop()) {
    Sample next;
    status = facebow.read(clock.now_ns() + settings.patience_ns, next);
    if (status == hal::Status::ok) {
      sample = next;
      ++counts.samples;
      const auto estimate = sensor.process(sample, checker.check(sample));
      counts.events.add(estimate.events);
      sink(sample, estimate);
    } else if (status == hal::Status::timeout) {
      ++counts.timeouts;
    } else if (status == hal::Status::bad_report) {
      ++counts.bad_reports;
    } else if (status == hal::Status::disconnected) {
      ++counts.disconnections;
      if (settings.reopen_pause_ns == 0) break;
      while (!should_stop() && facebow.open() != hal::Status::ok) {
        clock.sleep_until(clock.now_ns() + settings.reopen_pause_ns);
      }
    } else {
      break;
    }
    status = hal::Status::ok;
  }
  typename Sensor::Estimate waiting;
  while (sensor.drain(waiting)) {
    counts.events.add(waiting.events);
    sink(sample, waiting);
  }
  return status;
}

}  // namespace condyle::firmware
