// SPDX-License-Identifier: Apache-2.0
#include "report/report_section.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>

#include "comparison/compared_estimator.h"
#include "condyle/firmware/run_loop.h"
#include "condyle/hal/clock.h"
#include "hosted/files/input_error.h"
#include "output/replay_summary.h"
#include "readings/analysis_stop.h"

namespace condyle::host {
namespace {

constexpr double kDistantOrigin_s = 1e5;
constexpr int kMostLag = 16;

// One estimator in the run loop.
class ReportedSensor {
 public:
  struct Estimate {
    EventSet events;
    std::optional<EstimateRow> row;
  };
  explicit ReportedSensor(ComparedEstimator& estimator) : estimator_(estimator) {}
  Estimate process(const Sample& sample, EventSet events) {
    return {events, estimator_.process(sample, events)};
  }
  bool drain(Estimate& estimate) {
    estimate = {{}, estimator_.drain()};
    return estimate.row.has_value();
  }

 private:
  ComparedEstimator& estimator_;
};

// A position was measured, at a time of its own.
bool is_usable(const EstimateRow& row) {
  constexpr Event kUnusable[] = {
      Event::time_reversed,    Event::time_repeated,     Event::position_missing,
      Event::zero_filled,      Event::position_repeated, Event::position_frozen,
      Event::points_not_rigid, Event::outlier_rejected,  Event::position_out_of_range};
  return row.time_ns && std::none_of(std::begin(kUnusable), std::end(kUnusable),
                                     [&row](Event event) { return row.events.has(event); });
}

void refuse_drive(const ReportChoice& choice, const std::string& source,
                  const RecordingInfo& info) {
  if (!choice.drive_file.empty() && info.has_drive) {
    throw InputError(source, "has a drive of its own", "leave out --drive");
  }
  if (choice.drive_file.empty() && choice.drive.is_given() && !info.has_drive) {
    throw InputError(source, "has no drive, so options of the drive do not apply",
                     "give one with --drive FILE, or leave out these options");
  }
}

// The estimates over time of one recording.
class ReportedEstimates {
 public:
  // Opens and checks the recording.
  ReportedEstimates(const std::string& source, const ReportChoice& choice, ReportSection& section)
      : followed_{choice.followed, choice.analysis.reading}, section_(section) {
    followed_.reading.faults = FaultPolicy::event;
    facebow_.emplace(source, followed_.reading, 0, clock_);
    if (facebow_->open() != hal::Status::ok) throw InputError(facebow_->problem());
    const RecordingInfo& info = facebow_->info();
    followed_.check(source, info);
    refuse_drive(choice, source, info);
    section.format = info.format;
    section.notes = info.notes;
    settings_ = facebow_->run_settings(followed_.followed);
    EstimatorChoice estimator;
    const double step_s = seconds(settings_.nominal_step_ns);
    estimator.lag =
        step_s > 0 ? std::clamp(static_cast<int>(std::lround(kReportLag_s / step_s)), 0, kMostLag)
                   : 0;
    if (!choice.drive_file.empty()) channel_.emplace(choice.drive_file, FaultPolicy::event);
    compared_ = make_compared_estimator(estimator, followed_, choice.drive, source, *facebow_,
                                        {&fits_, channel_ ? &*channel_ : nullptr});
    section.parameters = compared_parameters(estimator, choice.drive, source, info);
    section.lag = estimator.lag;
  }

  void run(const std::function<void(double)>& progress, const std::function<bool()>& should_stop) {
    RecommendedSummary summary(*section_.parameters, section_.lag, followed_.followed.axis, fits_);
    std::optional<ImpedanceEstimate<double>> impedance;
    summary.set_conclusion([&] { return *impedance; });
    ReportedSensor sensor(*compared_);
    firmware::RunCounts counts;
    const hal::Status status = firmware::run(
        *facebow_, clock_, sensor, settings_, counts,
        [&](const Sample&, const ReportedSensor::Estimate& estimate) {
          if (!estimate.row) return;
          section_.series.add(*estimate.row);
          section_.fine.add(*estimate.row);
          summary.add(*estimate.row);
          if (is_usable(*estimate.row)) {
            section_.sample_times_s.push_back(seconds(*estimate.row->time_ns));
          }
          if (counts.samples % 1024 == 0) progress(facebow_->progress());
        },
        [&] { return should_stop() || !facebow_->problem().empty(); });
    if (!facebow_->problem().empty()) throw InputError(facebow_->problem());
    if (status == hal::Status::ok) return;  // stopped
    impedance = compared_->conclude();
    if (impedance) {
      section_.impedance = impedance;
      section_.impedance_parameters = section_.parameters->impedance;
      const std::vector<std::string> notes = compared_->drive_notes();
      section_.notes.insert(section_.notes.end(), notes.begin(), notes.end());
    }
    section_.summary = summary.text();
    section_.estimates_json = summary.json().dump();
    section_.warnings = summary.warnings();
  }

 private:
  RecordingChoice followed_;
  ReportSection& section_;
  hal::SteadyClock clock_;
  std::optional<ReplayFacebow> facebow_;
  firmware::RunSettings settings_;
  BodyFits fits_;
  std::optional<DriveChannel> channel_;
  std::unique_ptr<ComparedEstimator> compared_;
};

}  // namespace

ReportSection report_section(const std::string& source, const ReportChoice& choice,
                             const std::function<void(double)>& progress,
                             const std::function<bool()>& should_stop) {
  ReportSection section;
  section.recording = source;
  RecordingOptions reading = choice.analysis.reading;
  reading.faults = FaultPolicy::event;
  const auto recording = open_with_all_points(source, reading);
  std::optional<ReportedEstimates> estimates;
  if (is_read_as_bodies(*recording, choice.analysis.bodies)) {
    section.format = recording->info().format;
    section.notes.emplace_back(
        "estimates over time are left out: they follow one point of the instrument, and a body of "
        "several points was read");
  } else {
    estimates.emplace(source, choice, section);
  }
  if (!choice.analysis.landmarks.empty()) {
    section.landmarks = load_landmarks(choice.analysis.landmarks);
  }
  // Estimates and readings take about as long, and nothing here depends on the others.
  auto identity = std::async(std::launch::async, [&] {
    return identity_of(source, {{"landmarks", choice.analysis.landmarks, ""},
                                {"tasks", choice.tasks_file, ""},
                                {"drive", choice.drive_file, ""},
                                {"profile", choice.analysis.reading.profile, ""}});
  });
  std::atomic<bool> is_over = false;
  auto analysis = std::async(std::launch::async, [&] {
    return analyse_until(source, choice.analysis, [&is_over] { return is_over.load(); });
  });
  // Whatever ends this function ends the readings too.
  const std::unique_ptr<std::atomic<bool>, void (*)(std::atomic<bool>*)> end(
      &is_over, [](std::atomic<bool>* over) { *over = true; });
  if (estimates) estimates->run([&](double share) { progress(share / 2); }, should_stop);
  constexpr std::chrono::milliseconds kPatience(50);
  do {
    if (should_stop()) return section;
  } while (analysis.wait_for(kPatience) != std::future_status::ready);
  section.identity = identity.get();
  if (!section.series.runs().empty() &&
      std::abs(section.series.runs().front().time_s) > kDistantOrigin_s) {
    section.origin_s = section.series.runs().front().time_s;
  }
  try {
    section.analysis = analysis.get();
    section.sample_times_s.clear();
  } catch (const InputError& error) {
    // Tasks and landmarks that do not fit are the user's to mend.
    const AnalysisChoice& given = choice.analysis;
    const bool is_empty = !estimates;  // nothing else is on the page
    if (is_empty || !given.landmarks.empty() || !given.tasks.empty() || given.reference_s ||
        given.bodies.is_given()) {
      throw;
    }
    section.no_readings = error.what();
  }
  return section;
}

}  // namespace condyle::host
