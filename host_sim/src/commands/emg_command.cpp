// SPDX-License-Identifier: Apache-2.0
// Friction from EMG.
#include "commands/emg_command.h"

#include <fmt/format.h>

#include <memory>

#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "output/output_file.h"
#include "output/report_text.h"
#include "protocols/emg/emg_report.h"

namespace condyle::host {
namespace {

struct EmgOptions {
  EmgSource source;  // without noise
  std::string muscles, out;
  double noise_mm = 0.05;
  std::optional<double> mass_kg, mass_sd_kg, resolution_Ns_m, error_share;
};

int run(const EmgOptions& options) {
  EmgSource source = options.source;
  source.noise_sd_m = 1e-3 * options.noise_mm;
  source.emg_reading.faults = source.choice.reading.faults;
  const bool is_json = options.out.ends_with(".json");
  if (!options.out.empty() && !is_json && !options.out.ends_with(".csv")) {
    throw InputError(options.out, "is neither .json nor .csv",
                     "give NAME.json for the values or NAME.csv for a row per position");
  }
  source.keeps_rows = !options.out.empty() && !is_json;
  refuse_same_files({source.recording, source.emg, options.muscles, source.choice.reading.profile},
                    {options.out});

  MuscleFile muscles = load_muscles(options.muscles);
  EmgParameters& parameters = muscles.identification;
  parameters.mass_kg.mean = options.mass_kg.value_or(parameters.mass_kg.mean);
  parameters.mass_kg.sd = options.mass_sd_kg.value_or(parameters.mass_kg.sd);
  parameters.error_share = options.error_share.value_or(parameters.error_share);
  parameters.friction_resolution_Ns_m =
      options.resolution_Ns_m.value_or(parameters.friction_resolution_Ns_m);
  const EmgResult result = identify_from_emg(source, muscles);
  std::string text = banner() + emg_text(result);
  if (!options.out.empty()) {
    OutputFile file(options.out);
    file.write(is_json ? emg_json(result) : result.rows);
    file.close();
    file.commit();
    text += clean_line(file.path()) + "\n";
  }
  print_output(text);
  return kExitOk;
}

}  // namespace

Command add_emg(CommandLine app) {
  auto options = std::make_shared<EmgOptions>();
  const CommandLine command = app.add_command("emg",
                                              "Estimate friction from EMG and a muscle model, with "
                                              "the mass assumed; or report that it is not known");
  command.add_example("condyle protocol emg food.csv --emg food.emg.csv --muscles artisynth.toml",
                      "Envelopes of the EMG; a muscle model in a file.");
  command.add_example(
      "condyle protocol emg food.csv --emg food.emg.csv --muscles artisynth.toml --out values.json",
      "The values also as JSON.");
  command.add_option("RECORDING", options->source.recording, "As for replay").required();
  command
      .add_option(
          "--emg=FILE", options->source.emg,
          "CSV: time_s and one column for each muscle; or C3D: one analogue channel for each")
      .required();
  command
      .add_option("--muscles=FILE", options->muscles,
                  "TOML file: jaw, muscles, their columns; host_sim/muscles has examples")
      .required();
  command.add_flag("--raw", options->source.emg_reading.is_raw,
                   "The columns are raw EMG, not envelopes");
  command
      .add_option("--raw-maximum", options->source.emg_reading.raw_maximum,
                  "Envelope of a maximal contraction, for muscles whose maximum the file does not "
                  "give")
      .number_in({1e-12, 1e12});
  command.add_option("--assumed-mass-kg", options->mass_kg, "Mass at the followed point")
      .number_in({1e-6, 100});
  command.add_option("--assumed-mass-sd-kg", options->mass_sd_kg, "Its standard deviation")
      .number_in({0, 100});
  command
      .add_option("--error-share", options->error_share,
                  "rms error of the muscles' force, as a share of that force (0.46)")
      .number_in({1e-3, 10});
  command
      .add_option("--friction-resolution-Ns-m", options->resolution_Ns_m,
                  "Smallest difference of friction that matters to you (0.1)")
      .number_in({1e-9, 1e6});
  command.add_option("--noise-mm", options->noise_mm, "Standard deviation of a measured position")
      .number_in({1e-6, 100})
      .show_default();
  add_recording_options(command, options->source.choice);
  command.group("Output").add_option(
      "-o,--out=FILE", options->out,
      "NAME.json for the values, NAME.csv for one row for each position");
  return [options] { return run(*options); };
}

}  // namespace condyle::host
