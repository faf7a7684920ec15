// SPDX-License-Identifier: Apache-2.0
#include "comparison/compared_recording.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <filesystem>

#include "condyle/firmware/run_loop.h"
#include "hosted/files/input_error.h"
#include "recordings/recording_files.h"
#include "statistics/monte_carlo.h"

namespace condyle::host {
namespace {

// Runs all estimators in the run loop as one virtual sensor. Collects the rows of one instant,
// independent of the estimators' lags.
class LockstepSensor {
 public:
  struct Estimate {
    EventSet events;
    const LockstepSensor* sensor = nullptr;
  };

  explicit LockstepSensor(const std::vector<std::unique_ptr<ComparedEstimator>>& estimators)
      : estimators_(estimators), waiting_(estimators.size()) {}

  Estimate process(const Sample& sample, EventSet events) {
    for (std::size_t i = 0; i < estimators_.size(); ++i) {
      if (auto row = estimators_[i]->process(sample, events)) waiting_[i].push_back(*row);
    }
    return {events, this};
  }
  // The events of samples are counted once, in process.
  bool drain(Estimate& estimate) {
    bool has_more = false;
    for (std::size_t i = 0; i < estimators_.size(); ++i) {
      if (auto row = estimators_[i]->drain()) {
        waiting_[i].push_back(*row);
        has_more = true;
      }
    }
    estimate = {{}, this};
    return has_more;
  }

  // The next rows of one instant, one for each estimator; false if one is still delayed.
  bool next_rows(std::vector<EstimateRow>& rows) {
    for (const auto& queue : waiting_) {
      if (queue.empty()) return false;
    }
    rows.clear();
    for (auto& queue : waiting_) {
      rows.push_back(queue.front());
      queue.pop_front();
    }
    return true;
  }

 private:
  const std::vector<std::unique_ptr<ComparedEstimator>>& estimators_;
  std::vector<std::deque<EstimateRow>> waiting_;  // at most the longest lag
};

// Time between rows, if in order.
class RowSteps {
 public:
  // Seconds since the row before; NaN if that is not known.
  double add(const EstimateRow& row) {
    double step_s = EstimateRow::kNone;
    if (!row.time_ns || row.events.has(Event::time_reversed)) return step_s;
    if (previous_ns_ && !row.events.has(Event::time_restarted)) {
      step_s = seconds(*row.time_ns - *previous_ns_);
      duration_s_ += step_s;
    }
    previous_ns_ = row.time_ns;
    return step_s;
  }
  double duration_s() const { return duration_s_; }

 private:
  std::optional<TimeNs> previous_ns_;
  double duration_s_ = 0;
};

void check_recording(const std::string& source, const RecordingInfo& info,
                     const ComparisonPlan& plan) {
  plan.choice.check(source, info);
  if (!plan.drive.is_given() || info.has_drive) return;
  throw InputError(source, "has no drive that could be described",
                   "give it a column drive_N, or leave out the options of a drive");
}

// The recommended estimator without a parameter file.
bool takes_own_parameters(const NamedEstimator& named) {
  return !named.option.is_published() && named.option.parameters.empty();
}

RecordingReport compare_recording(const std::string& source, const ComparisonPlan& plan,
                                  std::atomic<double>& progress,
                                  const std::function<bool()>& should_stop) {
  hal::SteadyClock clock;
  ReplayFacebow facebow(source, plan.choice.reading, 0, clock);
  if (facebow.open() != hal::Status::ok) throw InputError(facebow.problem());
  const RecordingInfo& info = facebow.info();
  check_recording(source, info, plan);
  const firmware::RunSettings settings = facebow.run_settings(plan.choice.followed);

  RecordingReport report;
  report.step_s = seconds(settings.nominal_step_ns);
  const std::uint64_t block =
      report.step_s > 0 ? static_cast<std::uint64_t>(std::ceil(kScoreBlock_s / report.step_s)) : 0;
  std::vector<std::unique_ptr<ComparedEstimator>> estimators;
  std::vector<RunStatistics> statistics;
  for (const NamedEstimator& named : plan.estimators) {
    estimators.push_back(
        make_compared_estimator(named.option, plan.choice, plan.drive, source, facebow));
    statistics.emplace_back(block, plan.choice.followed.axis, estimators.back()->estimates_noise());
  }
  LockstepSensor sensor(estimators);
  RowSteps steps;
  std::vector<EstimateRow> rows;
  const auto take_rows = [&] {
    while (sensor.next_rows(rows)) {
      const double step_s = steps.add(rows[0]);
      bool is_compared = true;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        is_compared = is_compared && statistics[i].has_prediction(rows[i]);
      }
      report.compared += is_compared ? 1U : 0U;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        statistics[i].add(rows[i], rows[0], step_s, is_compared);
      }
    }
  };
  firmware::RunCounts counts;
  (void)firmware::run(
      facebow, clock, sensor, settings, counts,
      [&](const Sample&, const LockstepSensor::Estimate&) {
        take_rows();
        if (counts.samples % 256 == 0) progress = facebow.progress();
      },
      [&] { return should_stop() || !facebow.problem().empty(); });
  if (!facebow.problem().empty()) throw InputError(facebow.problem());
  progress = 1;

  report.source = source;
  report.format = info.format;
  report.kind = info.kind;
  report.notes = info.notes;
  if (!info.parameters_toml.empty() &&
      std::any_of(plan.estimators.begin(), plan.estimators.end(), takes_own_parameters)) {
    report.notes.emplace_back("recommended runs with the parameters that it was recorded with");
  }
  report.samples = counts.samples;
  report.gaps = counts.events[Event::time_gap];
  report.duration_s = steps.duration_s();
  for (const RunStatistics& run : statistics) report.runs.push_back(run.report());
  return report;
}

}  // namespace

NamedEstimator parse_estimator(const std::string& text, int lag) {
  NamedEstimator named{text, {}};
  const std::size_t colon = text.find(':');
  named.option.name = text.substr(0, colon);
  if (colon != std::string::npos) named.option.parameters = text.substr(colon + 1);
  if ((named.option.name != "recommended" && named.option.name != "published") ||
      (colon != std::string::npos && named.option.parameters.empty())) {
    throw InputError("--with " + text, "is not an estimator",
                     "give recommended or published, or either with its parameters: "
                     "recommended:FILE.toml");
  }
  if (!named.option.is_published()) named.option.lag = lag;
  return named;
}

void check_recordings(const std::vector<std::string>& sources, const ComparisonPlan& plan) {
  for (const NamedEstimator& named : plan.estimators) {
    if (named.option.is_published()) {
      (void)named.option.load_published();
    } else {
      (void)named.option.load_recommended();
    }
  }
  for (const std::string& source : sources) {
    const std::vector<std::string> files = recording_files(source);
    // A pipe can be read only once.
    if (std::any_of(files.begin(), files.end(),
                    [](const std::string& file) { return std::filesystem::is_fifo(file); })) {
      continue;
    }
    check_recording(source, open_recording(source, plan.choice.reading)->info(), plan);
  }
}

std::vector<RecordingReport> compare_recordings(const std::vector<std::string>& sources,
                                                const ComparisonPlan& plan,
                                                const ComparisonControl& control) {
  std::vector<std::atomic<double>> shares(sources.size());
  const auto show = [&] {
    double sum = 0;
    for (const auto& share : shares) sum += share;
    if (control.progress) control.progress(sum / static_cast<double>(shares.size()));
  };
  MonteCarloControl work;
  work.stop = control.should_stop;
  work.while_waiting = show;
  std::vector<RecordingReport> reports;
  run_monte_carlo(
      sources.size(), 0,
      [&](std::uint64_t index) {
        const auto i = static_cast<std::size_t>(index);
        return compare_recording(sources[i], plan, shares[i], control.should_stop);
      },
      [&](RecordingReport&& report) { reports.push_back(std::move(report)); },
      [&](std::uint64_t, std::uint64_t) { show(); }, work);
  return reports;
}

}  // namespace condyle::host
