// SPDX-License-Identifier: Apache-2.0
// Tunes the estimators to recordings.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "commands.h"
#include "condyle/hal/clock.h"
#include "estimator_option.h"
#include "input_error.h"
#include "number_option.h"
#include "progress.h"
#include "tuning/likelihood_tuning.h"
#include "tuning/tuning_report.h"

namespace condyle::host {
namespace {

struct TuneOptions {
  std::vector<std::string> recordings;
  std::string criterion = "likelihood", parameters, out, figures;
  std::string axis = "z", unit, faults = "refuse";
  TuningInput input;
  std::size_t starts = 0, most_samples = 0;
  std::uint64_t seed = 1;
  std::vector<double> noise_mm, jerk_density;
};

// Reads all recordings, one after the other.
std::vector<TuningRecording> read_all(const TuneOptions& options, const TuningInput& input,
                                      hal::Clock& clock) {
  std::vector<TuningRecording> recordings;
  const auto count = static_cast<double>(options.recordings.size());
  Progress progress("reading", clock);
  for (const std::string& path : options.recordings) {
    recordings.push_back(read_for_tuning(
        path, input,
        [&](double share) {
          progress.show((static_cast<double>(recordings.size()) + share) / count);
        },
        stop_requested));
    if (stop_requested()) break;
  }
  return recordings;
}

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

// Files that are complete get their names, and are named.
std::string commit_all(const std::vector<std::unique_ptr<OutputFile>>& files) {
  std::string text;
  for (const auto& file : files) {
    file->commit();
    text += file->path() + "\n";
  }
  return text;
}

int tune_by_likelihood(const TuneOptions& options) {
  RecommendedParameters parameters;
  if (!options.parameters.empty()) parameters = load_recommended_parameters(options.parameters);
  const LikelihoodPlan plan = plan_of(options, parameters);
  TuningInput input = options.input;
  input.parameters = parameters;
  input.kept = KeptSamples::spread;
  input.most_samples =
      std::max(options.most_samples / options.recordings.size(), 2 * StretchKeeper::kStretch);
  // Opened first, so that an output that cannot be written is said before the work.
  std::unique_ptr<OutputFolder> folder;
  if (!options.figures.empty()) folder = std::make_unique<OutputFolder>(options.figures);
  std::vector<std::unique_ptr<OutputFile>> files;
  files.push_back(std::make_unique<OutputFile>(options.out));

  hal::SteadyClock clock;
  const std::vector<TuningRecording> recordings = read_all(options, input, clock);
  LikelihoodTuning tuning;
  if (!stop_requested()) {
    Progress progress("tuning", clock, 1);
    double last_share = 0;
    MonteCarloControl control;
    control.stop = [] { return stop_requested(); };
    control.while_waiting = [&] { progress.show(last_share); };
    tuning = tune_by_likelihood(
        recordings, plan,
        [&](double share) {
          last_share = share;
          progress.show(share);
        },
        control);
  }
  if (stop_requested()) {
    print_error("stopped; no file was left");
    return kExitInterrupted;
  }
  parameters.noise.adaptation = Adaptation::off;
  parameters.noise.position_sd_m = tuning.written.position_sd_m;
  parameters.noise.jerk_density_m2_s5 = tuning.written.jerk_density_m2_s5;
  files[0]->write(tuning_comment(recordings, plan, tuning) + parameters_toml(parameters));
  files[0]->close();
  if (folder) {
    for (auto& figure : draw_tuning(options.figures, recordings, tuning)) {
      files.push_back(std::move(figure));
    }
  }
  std::string text =
      fmt::format("condyle {}: research use only; this is no diagnosis\n", CONDYLE_VERSION);
  text += tuning_text(recordings, plan, tuning);
  print_output(text + commit_all(files));
  return kExitOk;
}

}  // namespace

Command add_tune(CLI::App& app) {
  auto options = std::make_shared<TuneOptions>();
  CLI::App* const command =
      app.add_subcommand("tune", "Find an estimator's noise parameters from recordings");
  command->add_option("RECORDING", options->recordings, "As for replay; one or more")->required();
  command
      ->add_option("--criterion", options->criterion,
                   "likelihood: what makes the recordings most likely (recommended estimator)")
      ->check(CLI::IsMember({"likelihood"}))
      ->capture_default_str();
  command->add_option("--out", options->out, "TOML file for the parameters")->required();
  command->add_option("--parameters", options->parameters,
                      "TOML file to start from; it also gives what is not tuned");
  command->add_option("--starts", options->starts, "Number of starts of the search (12)")
      ->check(CLI::Range(1, 10'000));
  command->add_option("--seed", options->seed, "From which starts are drawn")
      ->capture_default_str();
  command
      ->add_option("--noise-bounds-mm", options->noise_mm,
                   "Lowest and highest noise (0.0001 to 10)")
      ->expected(2)
      ->check(number_in({1e-4, 100}));
  command
      ->add_option("--jerk-density-bounds", options->jerk_density,
                   "Lowest and highest density of the jerk in m^2/s^5 (1e-6 to 1e6)")
      ->expected(2)
      ->check(number_in({1e-6, 1e6}));
  options->most_samples = 200'000;
  command
      ->add_option("--most-samples", options->most_samples,
                   "Samples kept in memory, of all recordings together")
      ->check(CLI::Range(2'000, 100'000'000))
      ->capture_default_str();
  command->add_option("--point", options->input.followed.point, "Point to follow")
      ->check(CLI::Range(1, 3))
      ->capture_default_str();
  CLI::Option* const axis_option = command->add_option("--axis", options->axis, "Axis to tune to")
                                       ->check(CLI::IsMember({"x", "y", "z"}))
                                       ->capture_default_str();
  command->add_option("--unit", options->unit, "Unit of coordinates where the format states none")
      ->check(CLI::IsMember({"mm", "m"}));
  command
      ->add_option("--faults", options->faults,
                   "What to do with missing, non-finite and reversed rows")
      ->check(CLI::IsMember({"refuse", "event"}))
      ->capture_default_str();
  command
      ->add_option("--ignore-column", options->input.reading.ignored_columns,
                   "CSV column to leave unread; may be given several times")
      ->allow_extra_args(false);
  command->add_option("--profile", options->input.reading.profile,
                      "TOML file that describes the device of a capture");
  command->add_option("--figures", options->figures, "Folder for figures (SVG and PNG)");
  return [options, axis_option] {
    TuningInput& input = options->input;
    input.followed.axis = static_cast<Axis>(options->axis[0] - 'x');
    input.axis_given = axis_option->count() > 0;
    input.reading.faults = options->faults == "event" ? FaultPolicy::event : FaultPolicy::refuse;
    if (!options->unit.empty()) {
      input.reading.units_per_metre = options->unit == "mm" ? 1000 : 1;
    }
    std::vector<std::string> inputs = options->recordings;
    inputs.push_back(options->parameters);
    inputs.push_back(input.reading.profile);
    refuse_same_files(inputs, {options->out});
    return tune_by_likelihood(*options);
  };
}

}  // namespace condyle::host
