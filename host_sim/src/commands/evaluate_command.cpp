// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "commands/commands.h"
#include "evaluation/estimator_evaluation.h"
#include "evaluation/evaluation_figures.h"
#include "evaluation/evaluation_shard.h"
#include "evaluation/evaluation_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/text_file.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "options/shard_option.h"
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
  std::string shard;
  std::vector<std::string> shards;
  DriveStatement drive;
};

EvaluationShard shard_of(const std::string& text, std::uint64_t runs) {
  const auto [number, count] = parse_shard(text);
  if (count > runs) {
    throw InputError("--shard " + text, fmt::format("leaves shards without any of {} runs", runs),
                     "use at most as many shards as runs");
  }
  return {number, count};
}

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
  const double kernels = std::floor(recommended.parameters.learning.kernels);
  return fmt::format("recommended estimator, lag {} samples, assumed mass {:g} kg{}",
                     recommended.lag, recommended.parameters.assumed_mass_kg,
                     kernels >= 1 ? fmt::format(", learning with {:g} kernels", kernels) : "");
}

// A signal ends the runs.
MonteCarloControl control_of_signals() {
  MonteCarloControl control;
  control.stop = [] { return stop_requested(); };
  return control;
}

int evaluate_one_shard(const EvaluateOptions& options, const Scenario& scenario,
                       const EstimatorSettings& settings) {
  const EvaluationShard shard = shard_of(options.shard, options.plan.runs);
  if (options.out.empty() || !options.figures.empty()) {
    throw InputError("--shard", options.out.empty() ? "has no file for its runs" : "draws nothing",
                     "give --out FILE without --figures; condyle evaluate merge joins the files");
  }
  OutputFile file(options.out);
  const EvaluationSetup setup{scenario.name, read_text_file(options.scenario), describe(settings),
                              settings, options.plan};
  file.write(shard_header(setup, shard));
  hal::SteadyClock clock;
  {
    Progress progress("evaluating", clock, 1);
    evaluate_shard(
        scenario, settings, options.plan, shard,
        [&](const EvaluationRun& run) { file.write(run_line(run)); },
        [&](double share) { progress.show(share); }, control_of_signals());
  }
  if (stop_requested()) return report_stop();
  file.close();
  file.commit();
  print_output(fmt::format(
      "shard {} of {}: runs {} to {} of {} from seed {}, {}; simulated subjects, research use "
      "only\n"
      "{}\n",
      shard.number, shard.count, shard.begin(options.plan.runs) + 1, shard.end(options.plan.runs),
      scenario.name, options.plan.first_seed, describe(settings), options.out));
  return kExitOk;
}

std::string report_of(const std::string& scenario, const std::string& estimator,
                      const EvaluationPlan& plan, const Evaluation& evaluation) {
  return fmt::format("{} runs of {} from seed {}, {}; simulated subjects, research use only\n\n",
                     plan.runs, scenario, plan.first_seed, estimator) +
         evaluation_text(evaluation);
}

int merge(const std::vector<std::string>& shards, const std::string& out) {
  if (shards.empty()) {
    throw InputError("condyle evaluate merge", "no file is given",
                     "give the files of condyle evaluate --shard");
  }
  refuse_same_files(shards, {out});
  std::vector<std::unique_ptr<OutputFile>> files;
  if (!out.empty()) files.push_back(std::make_unique<OutputFile>(out));
  const MergedEvaluation merged = merge_shards(shards);
  if (!files.empty()) {
    files[0]->write(evaluation_csv(merged.evaluation));
    files[0]->close();
  }
  std::string text = report_of(merged.scenario, merged.estimator, merged.plan, merged.evaluation);
  text += commit_all(files);
  print_output(text);
  return kExitOk;
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
  if (!options.shard.empty()) return evaluate_one_shard(options, scenario, settings);
  std::unique_ptr<OutputFolder> folder;
  if (!options.figures.empty()) folder = std::make_unique<OutputFolder>(options.figures);
  std::vector<std::unique_ptr<OutputFile>> files;
  if (!options.out.empty()) files.push_back(std::make_unique<OutputFile>(options.out));

  hal::SteadyClock clock;
  Evaluation evaluation;
  {
    Progress progress("evaluating", clock, 1);
    evaluation = evaluate_estimator(
        scenario, settings, options.plan, [&](double share) { progress.show(share); },
        control_of_signals());
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
  std::string text = report_of(scenario.name, describe(settings), options.plan, evaluation);
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
  command.add_example("condyle evaluate merge shard1.txt shard2.txt -o errors.csv",
                      "Join the files of --shard 1/2 and 2/2: the bytes of one computer.");
  command
      .add_option("SCENARIO", options->scenario,
                  "TOML file; host_sim/scenarios has examples. The word merge joins shards")
      .required();
  command.add_option("FILE", options->shards,
                     "With merge: the files of evaluate --shard, in any order");
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
  command.add_option("--shard=I/N", options->shard,
                     "Only the I-th of N parts of the runs; --out then takes them for merge");
  command.group("Output").add_option("-o,--out=FILE", options->out, "CSV file for the table");
  command.group("Output").add_option("--figures=FOLDER", options->figures,
                                     "Folder for figures (SVG and PNG)");
  return [options] {
    if (options->scenario == "merge") return merge(options->shards, options->out);
    if (!options->shards.empty()) {
      throw InputError(options->shards[0], "is one argument too many",
                       "give one scenario, or merge and the files of its shards");
    }
    return evaluate(*options);
  };
}

}  // namespace condyle::host
