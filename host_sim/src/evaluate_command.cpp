// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "commands.h"
#include "evaluation/cascade_evaluation.h"
#include "gnuplot.h"
#include "input_error.h"
#include "number_option.h"
#include "output_file.h"
#include "parameter_file.h"
#include "progress.h"
#include "simulation/scenario_file.h"

namespace condyle::host {
namespace {

constexpr double kConfidence = 0.99;

struct EvaluateOptions {
  std::string scenario;
  std::string parameters;
  std::string out;
  std::string figures;
  EvaluationPlan plan;
};

std::string table(const Evaluation& evaluation) {
  std::string text =
      fmt::format("{:<10}{:>6} {:>22} {:>22} {:>22} {:>10} {:>8}\n", "quantity", "unit",
                  "error rms", "bias", "coverage of 95 %", "NES", "to bound");
  for (std::size_t i = 0; i < kEvaluatedQuantities; ++i) {
    const ErrorReport r = evaluation.errors[i].report(kConfidence);
    text += fmt::format(
        "{:<10}{:>6} {:>22} {:>22} {:>22} {:>10.3g} {:>8}\n", kEvaluated[i].name,
        kEvaluated[i].unit, fmt::format("{:.3g} +- {:.1g}", r.rms, r.rms_standard_error),
        fmt::format("{:.3g} +- {:.1g}", r.bias, r.bias_standard_error),
        fmt::format("{:.3f} ({:.2f}-{:.2f}){}", r.coverage, r.coverage_interval.low,
                    r.coverage_interval.high, r.coverage_is_nominal ? "" : " off"),
        r.mean_normalised_square,
        i < 3 ? fmt::format("{:.3g}", r.rms / evaluation.bound[i]) : std::string("-"));
  }
  std::uint64_t unusable = 0;
  for (const ErrorStatistics& errors : evaluation.errors) {
    unusable += errors.report(kConfidence).unusable;
  }
  if (unusable > 0) text += fmt::format("{} values were missing or not finite\n", unusable);
  const auto consistency = [&](const char* name, const ConsistencyReport& r) {
    text += fmt::format("{:<10}{:.4g}, consistent within {:.4g} to {:.4g}: {}\n", name, r.mean,
                        r.bounds.low, r.bounds.high, r.inside ? "inside" : "OUTSIDE");
  };
  consistency("NEES", evaluation.nees.report(kConfidence));
  consistency("NIS", evaluation.nis.report(kConfidence));
  const auto slope = [&](const char* name, const SlopeReport& r) {
    text += std::isfinite(r.slope)
                ? fmt::format("{:<10}d(estimate)/d(truth) = {:.4f} ({:.4f} to {:.4f})\n", name,
                              r.slope, r.slope_interval.low, r.slope_interval.high)
                : fmt::format("{:<10}no response slope: the truth did not vary\n", name);
  };
  slope("friction", evaluation.friction_slope.report(kConfidence));
  slope("mass", evaluation.mass_slope.report(kConfidence));
  text += fmt::format("verdicts  {} matched, {} not matched, {} diverged\n", evaluation.verdicts[1],
                      evaluation.verdicts[0], evaluation.verdicts[2]);
  return text +
         "Intervals and bounds at 99 %. NES: normalised error squared, 1 if the standard deviation "
         "is\n"
         "right. To bound: error rms over the Cramer-Rao bound of stage 1's own model, a random "
         "walk of\n"
         "force; below 1 where the motion is smoother than that. With the drive unknown there is "
         "no\n"
         "information on friction and mass, so their bound is their prior.\n";
}

std::string rows(const Evaluation& evaluation) {
  std::string text =
      "quantity,unit,error_rms,bias,coverage,mean_normalised_square,ratio_to_bound\n";
  for (std::size_t i = 0; i < kEvaluatedQuantities; ++i) {
    const ErrorReport r = evaluation.errors[i].report(kConfidence);
    text += fmt::format("{},{},{},{},{},{},{}\n", kEvaluated[i].name, kEvaluated[i].unit, r.rms,
                        r.bias, r.coverage, r.mean_normalised_square,
                        i < 3 ? fmt::format("{}", r.rms / evaluation.bound[i]) : "");
  }
  return text;
}

// Estimate against truth, with the line on which a measurement would lie.
std::vector<std::unique_ptr<OutputFile>> draw_responses(const std::string& directory,
                                                        const std::string& title,
                                                        const Evaluation& evaluation) {
  Gnuplot gnuplot(directory);
  gnuplot.send("set key left top\n");
  const auto draw = [&](const std::string& name, const std::string& unit,
                        const std::vector<ResponsePair>& pairs) {
    const auto [low, high] = std::minmax_element(
        pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.truth < b.truth; });
    if (!(high->truth > low->truth)) return;  // a response needs a truth that varies
    std::string block = fmt::format("${} << EOD\n", name);
    for (const ResponsePair& pair : pairs) {
      if (std::isfinite(pair.estimate)) block += fmt::format("{} {}\n", pair.truth, pair.estimate);
    }
    gnuplot.send(block + "EOD\n");
    gnuplot.send(fmt::format(
        "set title {} noenhanced\nset xlabel 'true effective {} ({})'\n"
        "set ylabel 'published cascade ({})'\n",
        gnuplot_quoted(title + ": does the estimate follow the truth?"), name, unit, unit));
    gnuplot.draw(
        name + "_response",
        fmt::format("plot x with lines dt 2 lc rgb '#0b559f' title 'a measurement would lie "
                    "here', ${} with points pt 7 ps 0.7 lc rgb '#606060' title 'estimate "
                    "at the end of a run (assumed)'",
                    name),
        640, 480);
  };
  draw("friction", "Ns/m", evaluation.friction);
  draw("mass", "kg", evaluation.mass);
  return gnuplot.finish();
}

int evaluate(const EvaluateOptions& options) {
  const Scenario scenario = load_scenario(options.scenario);
  const std::size_t variants =
      options.plan.friction_factors.size() * options.plan.mass_factors.size();
  if (options.plan.runs < 2 * variants) {
    throw InputError(
        "--runs", fmt::format("{} runs are too few for {} variants", options.plan.runs, variants),
        "give at least two a variant");
  }
  refuse_same_files({options.scenario, options.parameters}, {options.out});
  LoadedParameters loaded;
  if (!options.parameters.empty()) loaded = load_parameters(options.parameters);
  if (!loaded.gives_sample_time) loaded.values.sample_time_s = 1 / scenario.facebow.rate_Hz;
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
    evaluation = evaluate_cascade(
        scenario, loaded.values, options.plan,
        [&](std::uint64_t merged, std::uint64_t runs) {
          progress.show(static_cast<double>(merged) / static_cast<double>(runs));
        },
        control);
  }
  if (stop_requested()) {
    print_error("stopped; no file was left");
    return kExitInterrupted;
  }
  if (!files.empty()) {
    files[0]->write(rows(evaluation));
    files[0]->close();
  }
  if (folder) {
    for (auto& file : draw_responses(options.figures, scenario.name, evaluation)) {
      files.push_back(std::move(file));
    }
  }
  std::string text = fmt::format(
      "{} runs of {} from seed {}, published cascade, assumed mass {:g} kg; simulated subjects\n\n",
      options.plan.runs, scenario.name, options.plan.first_seed, loaded.values.assumed_mass_kg);
  text += table(evaluation);
  for (const auto& file : files) {
    file->commit();
    text += file->path() + "\n";
  }
  print_output(text);
  return kExitOk;
}

}  // namespace

Command add_evaluate(CLI::App& app) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* const command = app.add_subcommand(
      "evaluate", "Compare the estimator with the truth of simulated subjects, over many seeds");
  command->add_option("SCENARIO", options->scenario, "TOML file; host_sim/scenarios has some")
      ->required();
  command->add_option("--parameters", options->parameters,
                      "TOML file with the estimator's parameters");
  command->add_option("--runs", options->plan.runs, "Number of runs")
      ->check(number_in({2, 1e6}))
      ->capture_default_str();
  command->add_option("--seed", options->plan.first_seed, "First seed")->capture_default_str();
  command
      ->add_option("--friction-factors", options->plan.friction_factors,
                   "The subject's friction is multiplied by these in turn, separated by commas")
      ->delimiter(',')
      ->check(number_in({0, 1e6}));
  command
      ->add_option("--mass-factors", options->plan.mass_factors,
                   "The subject's mass and inertia are multiplied by these in turn")
      ->delimiter(',')
      ->check(number_in({1e-3, 1e3}));
  command->add_option("--out", options->out, "CSV file for the table");
  command->add_option("--figures", options->figures, "Folder for figures (SVG and PNG)");
  return [options] { return evaluate(*options); };
}

}  // namespace condyle::host
