// SPDX-License-Identifier: Apache-2.0
// Tunes the estimators to recordings.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "commands/commands.h"
#include "condyle/hal/clock.h"
#include "hosted/config/parameter_file.h"
#include "hosted/files/input_error.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "output/progress.h"
#include "output/report_text.h"
#include "recordings/recording_files.h"
#include "tuning/likelihood_tuning.h"
#include "tuning/published_recording.h"
#include "tuning/published_tuning_report.h"
#include "tuning/tuned_learning.h"
#include "tuning/tuning_report.h"

namespace condyle::host {
namespace {

constexpr std::size_t kLikelihoodSamples = 200'000, kPublishedSamples = 20'000;

struct TuneOptions {
  std::vector<std::string> recordings;
  std::string criterion = "likelihood", parameters, out, figures, tunings;
  RecordingChoice choice;
  std::size_t starts = 0, most_samples = 0;  // 0: the criterion's default
  std::uint64_t seed = 1;
  std::vector<double> noise_mm, jerk_density;

  bool is_published() const { return criterion == "published"; }
  // Samples kept of each recording, `fewest` at least.
  std::size_t share_of_samples(std::size_t by_default, std::size_t fewest) const {
    const std::size_t count = recordings.size();
    if (most_samples == 0) return std::max(by_default / count, fewest);
    if (most_samples / count >= fewest) return most_samples / count;
    throw InputError("--most-samples",
                     fmt::format("{} are too few for {} recordings", most_samples, count),
                     fmt::format("give {} or more, or fewer recordings", fewest * count));
  }
};

// Reads all recordings, one after the other; `read(path, show)` gives one.
template <class Read>
auto read_all(const TuneOptions& options, hal::Clock& clock, const Read& read) {
  std::vector<decltype(read(options.out, [](double) {}))> recordings;
  const auto count = static_cast<double>(options.recordings.size());
  Progress progress("reading", clock);
  for (const std::string& path : options.recordings) {
    recordings.push_back(read(path, [&](double share) {
      progress.show((static_cast<double>(recordings.size()) + share) / count);
    }));
    if (stop_requested()) break;
  }
  return recordings;
}

// Progress of a search, and its stop condition.
struct ShownSearch {
  explicit ShownSearch(hal::Clock& clock) : progress("tuning", clock, 1) {
    control.stop = [] { return stop_requested(); };
    control.while_waiting = [this] { progress.show(share); };
  }
  void show(double now) {
    share = now;
    progress.show(now);
  }

  Progress progress;
  double share = 0;
  MonteCarloControl control;
};

Range bounds_of(const char* option, const std::vector<double>& given, double scale,
                Range otherwise) {
  if (given.empty()) return otherwise;
  if (!(given[0] < given[1])) {
    throw InputError(
        option,
        fmt::format("the lower bound {:g} is not below the upper, {:g}", given[0], given[1]),
        "give the lower one first");
  }
  return {scale * given[0], scale * given[1]};
}

LikelihoodPlan plan_of(const TuneOptions& options, const RecommendedParameters& base) {
  LikelihoodPlan plan;
  plan.position_sd_m = bounds_of("--noise-bounds-mm", options.noise_mm, 1e-3, plan.position_sd_m);
  plan.jerk_density_m2_s5 =
      bounds_of("--jerk-density-bounds", options.jerk_density, 1, plan.jerk_density_m2_s5);
  if (!options.parameters.empty()) {
    plan.start = NoiseModel{base.noise.position_sd_m, base.noise.jerk_density_m2_s5, 0};
  }
  if (options.starts > 0) plan.starts = options.starts;
  plan.seed = options.seed;
  plan.with_surface = !options.figures.empty();
  plan.prior = base.prior;
  return plan;
}

// Prints the result.
int report(const std::string& found, const std::vector<std::unique_ptr<OutputFile>>& files,
           int exit_code) {
  print_output(banner() + found + commit_all(files));
  return exit_code;
}

int tune_likelihood(const TuneOptions& options, std::vector<std::unique_ptr<OutputFile>>& files) {
  RecommendedParameters parameters;
  if (!options.parameters.empty()) parameters = load_recommended_parameters(options.parameters);
  const LikelihoodPlan plan = plan_of(options, parameters);
  const TuningInput input{options.choice,
                          options.share_of_samples(kLikelihoodSamples, 2 * StretchKeeper::kStretch),
                          parameters};
  hal::SteadyClock clock;
  const auto recordings = read_all(options, clock, [&](const std::string& path, const auto& show) {
    return read_for_tuning(path, input, show, stop_requested);
  });
  if (stop_requested()) return report_stop();
  LikelihoodTuning tuning;
  {
    ShownSearch shown(clock);
    tuning = tune_by_likelihood(
        recordings, plan, [&](double share) { shown.show(share); }, shown.control);
  }
  if (stop_requested()) return report_stop();
  parameters.noise.adaptation = Adaptation::off;
  parameters.noise.position_sd_m = tuning.written.position_sd_m;
  parameters.noise.jerk_density_m2_s5 = tuning.written.jerk_density_m2_s5;
  files[0]->write(tuning_comment(recordings, plan, tuning) + parameters_toml(parameters));
  files[0]->close();
  if (!options.figures.empty()) {
    for (auto& figure : draw_tuning(options.figures, recordings, tuning)) {
      files.push_back(std::move(figure));
    }
  }
  const LearningCounts learned = learning_with(parameters, recordings);
  return report(tuning_text(recordings, plan, tuning) + learning_text(learned), files, kExitOk);
}

int tune_published(const TuneOptions& options, std::vector<std::unique_ptr<OutputFile>>& files) {
  LoadedParameters parameters;
  if (!options.parameters.empty()) parameters = load_parameters(options.parameters);
  PublishedTuningPlan plan;
  plan.seed = options.seed;
  if (options.starts > 0) plan.starts = options.starts;
  hal::SteadyClock clock;
  const auto recordings = read_all(options, clock, [&](const std::string& path, const auto& show) {
    const std::optional<double> sample_time_s = parameters.gives_sample_time
                                                    ? std::optional(parameters.values.sample_time_s)
                                                    : std::nullopt;
    return read_for_published(path, options.choice, sample_time_s,
                              options.share_of_samples(kPublishedSamples, kFewestTuned), show,
                              stop_requested);
  });
  if (stop_requested()) return report_stop();
  PublishedTuningResult result;
  {
    ShownSearch shown(clock);
    result = tune_by_published_criterion(
        recordings, parameters.values, plan,
        [&](std::uint64_t merged, std::uint64_t starts) {
          shown.show(static_cast<double>(merged) / static_cast<double>(starts));
        },
        shown.control);
  }
  if (stop_requested()) return report_stop();
  std::string found;
  for (const PublishedRecording& recording : recordings) {
    if (!recording.is_cut) continue;
    found += fmt::format("{:<14}of {}, only the first {} samples are judged (--most-samples)\n",
                         "note", recording.name, recording.position_m.size());
  }
  found += published_tuning_text(result);
  if (result.tunings.empty()) {
    files.clear();
    return report(found, files, kExitRefused);
  }
  parameters.values = result.tunings.front().parameters;
  files[0]->write(
      fmt::format("# Tuned by condyle {} so that it returns the assumed mass, as in the paper: one "
                  "of {} such tunings\n# found, with frictions a factor of {:.3g} apart. Friction "
                  "and mass are assumed, not measured.\n# Research use only.\n{}",
                  CONDYLE_VERSION, result.tunings.size(), result.friction_ratio(),
                  parameters_toml(parameters)));
  files[0]->close();
  if (!options.tunings.empty()) {
    files[1]->write(published_tunings_csv(result));
    files[1]->close();
  }
  if (!options.figures.empty()) {
    const std::string name = recording_name(recordings.front().name);
    for (auto& figure : draw_published_tunings(options.figures, name, result, recordings.front())) {
      files.push_back(std::move(figure));
    }
  }
  return report(found, files, kExitOk);
}

// Refuses options of the other criterion.
void check(const TuneOptions& options) {
  const auto refuse = [&](const char* option, bool given, const char* criterion) {
    if (!given || options.criterion == criterion) return;
    throw InputError(option, fmt::format("is not supported by the criterion {}", options.criterion),
                     fmt::format("leave it out, or give --criterion {}", criterion));
  };
  refuse("--jaw-point-mm", !options.choice.jaw_point_mm.empty(), "likelihood");
  refuse("--noise-bounds-mm", !options.noise_mm.empty(), "likelihood");
  refuse("--jerk-density-bounds", !options.jerk_density.empty(), "likelihood");
  refuse("--tunings", !options.tunings.empty(), "published");
  refuse_repeated_recordings(options.recordings);
  std::vector<std::string> inputs = options.recordings;
  inputs.push_back(options.parameters);
  inputs.push_back(options.choice.reading.profile);
  refuse_same_files(inputs, {options.out, options.tunings});
}

int tune(const TuneOptions& options) {
  check(options);
  // Opened first, to report an output that cannot be written before the work.
  std::unique_ptr<OutputFolder> folder;
  if (!options.figures.empty()) folder = std::make_unique<OutputFolder>(options.figures);
  std::vector<std::unique_ptr<OutputFile>> files;
  files.push_back(std::make_unique<OutputFile>(options.out));
  if (!options.tunings.empty()) files.push_back(std::make_unique<OutputFile>(options.tunings));
  return options.is_published() ? tune_published(options, files) : tune_likelihood(options, files);
}

}  // namespace

Command add_tune(CommandLine app) {
  auto options = std::make_shared<TuneOptions>();
  const CommandLine command = app.add_command(
      "tune", "Find an estimator's noise parameters from recordings", "Analyse recordings");
  command.add_example("condyle tune jaw.csv --out tuned.toml",
                      "Fit noise and jerk density to a recording.");
  command.add_example("condyle tune a.csv b.csv --out tuned.toml --figures figures",
                      "Fit them to several recordings, and draw the likelihood.");
  command.add_option("RECORDING", options->recordings, "As for replay; one or more").required();
  command
      .add_option("--criterion", options->criterion,
                  "likelihood: make the recordings most likely (recommended estimator); published: "
                  "make the published cascade return its assumed mass, as in the paper, which "
                  "leaves much open")
      .one_of({"likelihood", "published"})
      .show_default();
  command.group("Output")
      .add_option("-o,--out=FILE", options->out, "TOML file for the parameters")
      .required();
  command.add_option("--parameters=FILE", options->parameters,
                     "TOML file to start from; parameters that are not tuned keep its values");
  command
      .add_option("--starts", options->starts,
                  "Number of starts of the search (likelihood 12, published 100)")
      .within(1, 100'000);
  command.add_option("--seed", options->seed, "Seed of the random starts").show_default();
  command
      .add_option("--noise-bounds-mm", options->noise_mm,
                  "Lowest and highest noise (0.0001 10; likelihood)")
      .values(2)
      .number_in({1e-4, 100});
  command
      .add_option("--jerk-density-bounds", options->jerk_density,
                  "Lowest and highest jerk density in m^2/s^5 (1e-6 1e6; likelihood)")
      .values(2)
      .number_in({1e-6, 1e6});
  command
      .add_option("--most-samples", options->most_samples,
                  "Samples kept in memory, of all recordings together (likelihood 200000, evenly "
                  "spread; published 20000, the first)")
      .within(2'000, 100'000'000);
  add_recording_options(command, options->choice);
  command.group("Output").add_option(
      "--tunings=FILE", options->tunings,
      "CSV file for all tunings that satisfy the criterion (published)");
  command.group("Output").add_option("--figures=FOLDER", options->figures,
                                     "Folder for figures (SVG and PNG)");
  return [options] {
    options->choice.reading.may_lack_ignored = options->recordings.size() > 1;
    return tune(*options);
  };
}

}  // namespace condyle::host
