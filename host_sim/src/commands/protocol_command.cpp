// SPDX-License-Identifier: Apache-2.0
// Protocols for users without a force sensor: plan, fit and combine passive releases; the head's
// motion is in head_motion_command.cpp.
#include <fmt/format.h>

#include <memory>

#include "commands/commands.h"
#include "commands/emg_command.h"
#include "commands/head_motion_command.h"
#include "hosted/files/input_error.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "output/output_file.h"
#include "output/report_text.h"
#include "protocols/release/release_plan.h"
#include "protocols/release/release_report.h"

namespace condyle::host {
namespace {

// Options of both `release` and `combine`.
struct FitOptions {
  ReleaseSource source;  // without the recording and its times
  double noise_mm = 0;
  std::optional<double> let_go_ms;
  ReleaseResolution resolution;
  std::string out, figures;

  void add_to(CommandLine command) {
    add_recording_options(command, source.choice);
    command
        .add_option("--noise-mm", noise_mm,
                    "Standard deviation of a measured position; without it, that of the residuals, "
                    "which cannot reveal a wrong model")
        .number_in({1e-6, 100});
    command
        .add_option("--let-go-ms", let_go_ms,
                    "Time after the start at which the support was certainly gone; without it a "
                    "slow hand and an overdamped jaw look alike")
        .number_in({0, 1000});
    command.group("Output").add_option("-o,--out=FILE", out, "JSON file for the values");
    command.group("Output").add_option("--figures=FOLDER", figures,
                                       "Folder for figures (SVG and PNG)");
  }
  ReleaseSource source_of(const std::string& recording, std::optional<double> begin_s,
                          std::optional<double> end_s) const {
    ReleaseSource result = source;
    result.recording = recording;
    result.begin_s = begin_s;
    result.end_s = end_s;
    result.let_go_s = 1e-3 * let_go_ms.value_or(0);
    return result;
  }
  ReleaseSettings settings() const {
    ReleaseSettings result;
    result.noise_sd_m = 1e-3 * noise_mm;
    result.is_sudden = let_go_ms.has_value();
    result.resolution = resolution;
    return result;
  }
};

// Writes the requested files, then prints the text.
int finish(const FitOptions& options, const std::vector<std::string>& recordings,
           const std::string& text, const std::string& json,
           const std::vector<std::pair<std::string, const FittedRelease*>>& releases) {
  std::vector<std::string> inputs = recordings;
  inputs.push_back(options.source.choice.reading.profile);
  refuse_same_files(inputs, {options.out});
  std::unique_ptr<OutputFolder> folder;
  std::vector<std::unique_ptr<OutputFile>> files;
  if (!options.figures.empty()) {
    folder = std::make_unique<OutputFolder>(options.figures);
    files = draw_releases(options.figures, releases);
  }
  if (!options.out.empty()) {
    files.push_back(std::make_unique<OutputFile>(options.out));
    files.back()->write(json);
    files.back()->close();
  }
  std::string all = banner() + text;
  all += commit_all(files);
  print_output(all);
  return kExitOk;
}

const Range kTimeRange{0, 1e9};

Command add_plan(CommandLine app) {
  auto plan = std::make_shared<ReleasePlan>();
  const CommandLine command = app.add_command(
      "plan-release", "Print the expected standard deviation, and how long to record");
  command.add_example("condyle protocol plan-release --opening-mm 10",
                      "Plan a release: what precision to expect.");
  command.add_example("condyle protocol plan-release --wanted-damping-rate-sd-per-s 0.5",
                      "How many releases give kv/m with this standard deviation.");
  const auto add = [&](const char* name, double& value, const char* meaning, Range range) {
    command.add_option(name, value, meaning).number_in(range).show_default();
  };
  add("--rate-Hz", plan->rate_Hz, "Samples per second", {1, 1e4});
  add("--noise-mm", plan->noise_mm, "Standard deviation of a measured position", {1e-6, 100});
  add("--duration-s", plan->duration_s, "Length of the release", {1e-3, 60});
  add("--opening-mm", plan->opening_mm, "Distance from the rest position to the release",
      {1e-3, 100});
  add("--damping-rate-per-s", plan->damping_rate_per_s, "Expected kv/m", {0, 1e4});
  add("--natural-frequency-Hz", plan->natural_frequency_Hz,
      "Expected natural frequency, sqrt(ks/m) / (2 pi)", {1e-2, 1e3});
  command
      .add_option("--wanted-damping-rate-sd-per-s", plan->wanted_damping_rate_sd_per_s,
                  "Target standard deviation of kv/m")
      .number_in({1e-9, 1e9});
  return [plan] {
    print_output(plan_text(*plan));
    return kExitOk;
  };
}

Command add_release(CommandLine app) {
  struct Options : FitOptions {
    std::string recording;
    std::optional<double> begin_s, end_s;
  };
  auto options = std::make_shared<Options>();
  const CommandLine command = app.add_command(
      "release", "Fit a passive release: kv/m, ks/m, damping ratio and natural frequency");
  command.add_example("condyle protocol release release.csv --noise-mm 0.05",
                      "Fit a release; 0.05 mm of noise test the model.");
  command.add_example("condyle protocol release release.csv --let-go-ms 20 --figures figures",
                      "The support was gone after 20 ms; draw the fit.");
  command.add_option("RECORDING", options->recording, "As for replay").required();
  options->add_to(command);
  command
      .add_option("--begin-s", options->begin_s,
                  "Time of the release, from the first sample; by default it is detected")
      .number_in(kTimeRange);
  command
      .add_option("--end-s", options->end_s,
                  "Last time, from the first sample; by default 0.6 s after the start")
      .number_in(kTimeRange);
  command
      .add_option("--damping-rate-resolution-per-s", options->resolution.damping_rate_per_s,
                  "Smallest difference of kv/m that matters to you; a value counts as measured if "
                  "known to half of it")
      .number_in({1e-9, 1e9})
      .show_default();
  return [options] {
    const FittedRelease release =
        fit_release(options->source_of(options->recording, options->begin_s, options->end_s),
                    options->settings());
    return finish(*options, {options->recording}, release_text(release), release_json(release),
                  {{"release", &release}});
  };
}

Command add_combine(CommandLine app) {
  struct Options : FitOptions {
    std::string first, second;
    std::vector<double> begin_s, end_s;
    ReleasePairSettings pair;
  };
  auto options = std::make_shared<Options>();
  const CommandLine command = app.add_command(
      "combine", "Combine two releases, the second with a known load, into kv, ks and m");
  command.add_example("condyle protocol combine first.csv second.csv --added-mass-kg 0.2",
                      "Two releases, the second with 0.2 kg fixed to the jaw.");
  command.add_example(
      "condyle protocol combine first.csv second.csv --added-mass-kg 0.2 --added-weight-N 2",
      "The load also pulls with its weight.");
  command.add_option("FIRST", options->first, "Recording without the load").required();
  command.add_option("SECOND", options->second, "Recording with the load").required();
  options->add_to(command);
  const auto add_times = [command](const char* name, std::vector<double>& value,
                                   const char* meaning) {
    command.add_option(name, value, meaning).values(2).number_in(kTimeRange);
  };
  add_times("--begin-s", options->begin_s, "Start of the first and of the second release");
  add_times("--end-s", options->end_s, "End of the first and the second release");
  const auto add_load = [command](const std::string& name, const char* unit, KnownLoad& load,
                                  const char* meaning) {
    const Option value = command.add_option("--added-" + name + "-" + unit, load.value, meaning)
                             .number_in({-1e4, 1e4});
    command
        .add_option("--added-" + name + "-sd-" + unit, load.standard_deviation,
                    "Its standard deviation")
        .number_in({0, 1e4})
        .needs(value)
        .show_default();
  };
  add_load("mass", "kg", options->pair.load.mass_kg,
           "Mass fixed to the followed point; its weight counts only with --added-weight-N");
  add_load("spring", "N-m", options->pair.load.stiffness_N_m,
           "Spring between the point and the head (N/m)");
  add_load("weight", "N", options->pair.load.weight_N,
           "Constant force on the point, positive in the direction of growing position");
  command
      .add_option("--friction-resolution-Ns-m", options->pair.friction_resolution_Ns_m,
                  "Smallest difference of kv that matters to you")
      .number_in({1e-9, 1e6})
      .show_default();
  return [options] {
    const ReleaseLoad& load = options->pair.load;
    if (load.mass_kg.value == 0 && load.stiffness_N_m.value == 0 && load.weight_N.value == 0) {
      throw InputError("combine", "no load is given; without one the scale is not known",
                       "give --added-mass-kg, --added-spring-N-m or --added-weight-N");
    }
    if (load.stiffness_N_m.value != 0 && load.weight_N.value != 0) {
      throw InputError("--added-weight-N",
                       "cannot be used together with --added-spring-N-m, because the rest position "
                       "of the spring is not known",
                       "use one of them");
    }
    options->source.choice.reading.may_lack_ignored = true;
    const auto fit = [&](const std::string& recording, std::size_t i) {
      const auto at = [i](const std::vector<double>& times) {
        return times.empty() ? std::nullopt : std::optional(times[i]);
      };
      return fit_release(options->source_of(recording, at(options->begin_s), at(options->end_s)),
                         options->settings());
    };
    const FittedRelease first = fit(options->first, 0), second = fit(options->second, 1);
    const auto pair = combine_releases(first.fit, second.fit, options->pair);
    return finish(*options, {options->first, options->second}, pair_text(first, second, pair),
                  pair_json(first, second, pair),
                  {{"first_release", &first}, {"second_release", &second}});
  };
}

}  // namespace

Command add_protocol(CommandLine app) {
  const CommandLine command =
      app.add_command("protocol",
                      "Protocols without a force sensor: passive releases, the head's motion as "
                      "a drive, EMG",
                      "Analyse recordings");
  command.add_example("condyle protocol plan-release --opening-mm 10",
                      "Plan a passive release: what precision to expect.");
  command.add_example("condyle protocol release release.csv --noise-mm 0.05",
                      "Fit a passive release.");
  command.require_command();
  std::vector<std::pair<const char*, Command>> parts;
  parts.emplace_back("plan-release", add_plan(command));
  parts.emplace_back("release", add_release(command));
  parts.emplace_back("combine", add_combine(command));
  parts.emplace_back("plan-head-motion", add_plan_head_motion(command));
  parts.emplace_back("head-motion", add_head_motion(command));
  parts.emplace_back("emg", add_emg(command));
  return [command, parts] {
    for (const auto& [name, part] : parts) {
      if (command.is_given(name)) return part();
    }
    return kExitBadInput;
  };
}

}  // namespace condyle::host
