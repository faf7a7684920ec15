// SPDX-License-Identifier: Apache-2.0
#include "report/report_section.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "comparison/compared_estimator.h"
#include "condyle/firmware/run_loop.h"
#include "condyle/hal/clock.h"
#include "hosted/files/input_error.h"
#include "output/replay_summary.h"

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

void add_estimates(const std::string& source, const ReportChoice& choice,
                   const std::function<void(double)>& progress,
                   const std::function<bool()>& should_stop, ReportSection& section) {
  RecordingChoice followed{choice.followed, choice.analysis.reading};
  followed.reading.faults = FaultPolicy::event;
  hal::SteadyClock clock;
  ReplayFacebow facebow(source, followed.reading, 0, clock);
  if (facebow.open() != hal::Status::ok) throw InputError(facebow.problem());
  const RecordingInfo& info = facebow.info();
  followed.check(source, info);
  refuse_drive(choice, source, info);
  section.format = info.format;
  section.notes = info.notes;
  const firmware::RunSettings settings = facebow.run_settings(followed.followed);
  EstimatorChoice estimator;
  const double step_s = seconds(settings.nominal_step_ns);
  estimator.lag =
      step_s > 0 ? std::clamp(static_cast<int>(std::lround(kReportLag_s / step_s)), 0, kMostLag)
                 : 0;
  BodyFits fits;
  std::optional<DriveChannel> channel;
  if (!choice.drive_file.empty()) channel.emplace(choice.drive_file, FaultPolicy::event);
  const auto compared = make_compared_estimator(estimator, followed, choice.drive, source, facebow,
                                                {&fits, channel ? &*channel : nullptr});
  const RecommendedParameters parameters =
      compared_parameters(estimator, choice.drive, source, info);
  section.parameters = parameters;
  section.lag = estimator.lag;
  RecommendedSummary summary(parameters, estimator.lag, followed.followed.axis, fits);
  std::optional<ImpedanceEstimate<double>> impedance;
  summary.set_conclusion([&] { return *impedance; });
  ReportedSensor sensor(*compared);
  firmware::RunCounts counts;
  const hal::Status status = firmware::run(
      facebow, clock, sensor, settings, counts,
      [&](const Sample&, const ReportedSensor::Estimate& estimate) {
        if (!estimate.row) return;
        section.series.add(*estimate.row);
        section.fine.add(*estimate.row);
        summary.add(*estimate.row);
        if (is_usable(*estimate.row)) {
          section.sample_times_s.push_back(seconds(*estimate.row->time_ns));
        }
        if (counts.samples % 1024 == 0) progress(facebow.progress());
      },
      [&] { return should_stop() || !facebow.problem().empty(); });
  if (!facebow.problem().empty()) throw InputError(facebow.problem());
  if (status == hal::Status::ok) return;  // stopped
  impedance = compared->conclude();
  if (impedance) {
    section.impedance = impedance;
    section.impedance_parameters = parameters.impedance;
    const std::vector<std::string> notes = compared->drive_notes();
    section.notes.insert(section.notes.end(), notes.begin(), notes.end());
  }
  section.summary = summary.text();
  section.estimates_json = summary.json().dump();
  section.warnings = summary.warnings();
}

}  // namespace

ReportSection report_section(const std::string& source, const ReportChoice& choice,
                             const std::function<void(double)>& progress,
                             const std::function<bool()>& should_stop) {
  ReportSection section;
  section.recording = source;
  section.identity = identity_of(source, {{"landmarks", choice.analysis.landmarks, ""},
                                          {"tasks", choice.tasks_file, ""},
                                          {"drive", choice.drive_file, ""},
                                          {"profile", choice.analysis.reading.profile, ""}});
  RecordingOptions reading = choice.analysis.reading;
  reading.faults = FaultPolicy::event;
  const auto recording = open_with_all_points(source, reading);
  if (is_read_as_bodies(*recording, choice.analysis.bodies)) {
    section.format = recording->info().format;
    section.notes.emplace_back(
        "estimates over time are left out: they follow one point of the instrument, and a body of "
        "several points was read");
  } else {
    add_estimates(
        source, choice, [&](double share) { progress(share / 2); }, should_stop, section);
  }
  if (should_stop()) return section;
  if (!section.series.runs().empty() &&
      std::abs(section.series.runs().front().time_s) > kDistantOrigin_s) {
    section.origin_s = section.series.runs().front().time_s;
  }
  if (!choice.analysis.landmarks.empty()) {
    section.landmarks = load_landmarks(choice.analysis.landmarks);
  }
  try {
    section.analysis = analyse(source, choice.analysis);
    section.sample_times_s.clear();
  } catch (const InputError& error) {
    // Tasks and landmarks that do not fit are the user's to mend.
    const AnalysisChoice& analysis = choice.analysis;
    if (!analysis.landmarks.empty() || !analysis.tasks.empty() || analysis.reference_s ||
        analysis.bodies.is_given()) {
      throw;
    }
    section.no_readings = error.what();
  }
  return section;
}

}  // namespace condyle::host
