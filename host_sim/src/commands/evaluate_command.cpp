// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands/commands.h"
#include "evaluation/estimator_evaluation.h"
#include "evaluation/evaluation_figures.h"
#include "evaluation/evaluation_text.h"
#include "hosted/files/input_error.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "output/output_file.h"
#include "output/progress.h"
#include "simulation/scenario_file.h"

namespace condyle::host {
namespace {

struct EvaluateOptions {
  std::string scenario;
  EstimatorChoice estimator;
  std::string out;
  std::string figures;
  EvaluationPlan plan;
  DriveStatement drive;
};

EstimatorSettings choose_settings(const EvaluateOptions& options, const Scenario& scenario) {
  const EstimatorChoice& estimator = options.estimator;
  estimator.refuse_if_published("--lag", estimator.lag > 0);
  estimator.refuse_if_published("--drive-...", options.drive.is_given());
  if (options.drive.is_given() && !(scenario.drive.rate_Hz > 0)) {
    throw InputError(options.scenario, "has no drive, so options of the drive do not apply",
                     "add a [drive] section with rate_Hz");
  }
  const double step_s = 1 / scenario.facebow.rate_Hz;
  if (estimator.is_published()) {
    LoadedParameters loaded = estimator.load_published();
    if (!loaded.gives_sample_time) loaded.values.sample_time_s = step_s;
    return loaded.values;
  }
  RecommendedParameters parameters = estimator.load_recommended();
  options.drive.apply(parameters.impedance);
  refuse_long_step(parameters, step_s, options.scenario, "its step", "raise rate_Hz");
  return RecommendedSettings{parameters, estimator.lag};
}

// Which estimator, in words.
std::string describe(const EstimatorSettings& settings) {
  if (const auto* published = std::get_if<PublishedParameters>(&settings)) {
    return fmt::format("published cascade, assumed mass {:g} kg", published->assumed_mass_kg);
  }
  const auto& recommended = std::get<RecommendedSettings>(settings);
  return fmt::format("recommended estimator, lag {} samples, assumed mass {:g} kg", recommended.lag,
                     recommended.parameters.assumed_mass_kg);
}

int evaluate(const EvaluateOptions& options) {
  const Scenario scenario = load_scenario(options.scenario);
  const std::size_t variants =
      options.plan.friction_factors.size() * options.plan.mass_factors.size();
  if (options.plan.runs < 2 * variants) {
    throw InputError(
        "--runs", fmt::format("{} runs are too few for {} variants", options.plan.runs, variants),
        "give at least two runs for each variant");
  }
  refuse_same_files({options.scenario, options.estimator.parameters}, {options.out});
  const EstimatorSettings settings = choose_settings(options, scenario);
  std::unique_ptr<OutputFolder> folder;
  if (!options.figures.empty()) folder = std::make_unique<OutputFolder>(options.figures);
  std::vector<std::unique_ptr<OutputFile>> files;
  if (!options.out.empty()) files.push_back(std::make_unique<OutputFile>(options.out));

  hal::SteadyClock clock;
  Evaluation evaluation;
  {
    Progress progress("evaluating", clock, 1);
    MonteCarloControl control;
    control.stop = [] { return stop_requested(); };
    evaluation = evaluate_estimator(
        scenario, settings, options.plan, [&](double share) { progress.show(share); }, control);
  }
  if (stop_requested()) {
    return report_stop();
  }
  if (!files.empty()) {
    files[0]->write(evaluation_csv(evaluation));
    files[0]->close();
  }
  if (folder) {
    const std::string title = fmt::format("{} (simulated), {}", scenario.name, describe(settings));
    for (auto& file : draw_evaluation(options.figures, title, evaluation)) {
      files.push_back(std::move(file));
    }
  }
  std::string text =
      fmt::format("{} runs of {} from seed {}, {}; simulated subjects, research use only\n\n",
                  options.plan.runs, scenario.name, options.plan.first_seed, describe(settings));
  text += evaluation_text(evaluation);
  text += commit_all(files);
  print_output(text);
  return kExitOk;
}

}  // namespace

Command add_evaluate(CommandLine app) {
  auto options = std::make_shared<EvaluateOptions>();
  const CommandLine command = app.add_command(
      "evaluate", "Compare an estimator with the truth of simulated subjects, over many seeds",
      "Simulate");
  command.add_example("condyle evaluate chewing.toml --runs 10",
                      "Compare the recommended estimator with the truth, over ten seeds.");
  command.add_example(
      "condyle evaluate point_mass.toml --runs 10 --estimator published --friction-factors 1,22",
      "Show that the published friction does not follow the true one.");
  command.add_option("SCENARIO", options->scenario, "TOML file; host_sim/scenarios has examples")
      .required();
  add_estimator_options(command, options->estimator);
  add_drive_options(command, options->drive);
  command.add_option("--runs", options->plan.runs, "Number of runs")
      .number_in({2, 1e6})
      .show_default();
  command.add_option("--seed", options->plan.first_seed, "First seed").show_default();
  command
      .add_option("--friction-factors", options->plan.friction_factors,
                  "Factors of the subject's friction, one variant for each, separated by commas")
      .separated_by(',')
      .number_in({0, 1e6});
  command
      .add_option("--mass-factors", options->plan.mass_factors,
                  "Factors of the subject's mass and inertia, one variant for each")
      .separated_by(',')
      .number_in({1e-3, 1e3});
  command.group("Output").add_option("-o,--out=FILE", options->out, "CSV file for the table");
  command.group("Output").add_option("--figures=FOLDER", options->figures,
                                     "Folder for figures (SVG and PNG)");
  return [options] { return evaluate(*options); };
}

}  // namespace condyle::host
