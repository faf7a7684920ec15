// SPDX-License-Identifier: Apache-2.0
// The protocol in which the motion of the head drives a relaxed jaw.
#include "commands/head_motion_command.h"

#include <fmt/format.h>

#include <memory>

#include "hosted/files/input_error.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "output/output_file.h"
#include "output/report_text.h"
#include "protocols/head_motion/head_motion_plan.h"
#include "protocols/head_motion/head_motion_report.h"

namespace condyle::host {
namespace {

constexpr Range kPositive{1e-9, 1e6}, kTimes{0, 1e9};

// What the user states about accelerometer and muscles, in the user's units.
struct Stated {
  double gain_sd = HeadMotionParameters{}.gain_sd;
  double lever_sd = HeadMotionParameters{}.lever_sd;
  double delay_sd_ms = 1e3 * HeadMotionParameters{}.delay_sd_s;
  double muscle_share = HeadMotionParameters{}.muscle_share;

  void add_to(CommandLine command) {
    command
        .add_option("--acceleration-gain-sd", gain_sd,
                    "Relative uncertainty of the accelerometer's gain")
        .number_in({0, 1})
        .show_default();
    command
        .add_option("--lever-sd", lever_sd,
                    "Share of the acceleration by which the head's rotation may change it, if the "
                    "accelerometer is away from the jaw's axis")
        .number_in({0, 1})
        .show_default();
    command
        .add_option("--acceleration-delay-sd-ms", delay_sd_ms,
                    "Uncertainty of the delay of its time stamps")
        .number_in({0, 1000})
        .show_default();
    command
        .add_option("--muscle-share", muscle_share,
                    "Largest share of the inertial force that muscles may add; 0: the jaw is "
                    "relaxed, 1: not known")
        .number_in({0, 1})
        .show_default();
  }
  void apply(HeadMotionParameters& parameters) const {
    parameters.gain_sd = gain_sd;
    parameters.lever_sd = lever_sd;
    parameters.delay_sd_s = 1e-3 * delay_sd_ms;
    parameters.muscle_share = muscle_share;
  }
};

struct HeadMotionOptions {
  HeadMotionSource source;
  Stated stated;
  double delay_ms = 0;
  std::optional<double> noise_mm;
  double resolution_per_s = HeadMotionParameters{}.damping_rate_resolution_per_s;
  std::string out, figures;
};

int run(HeadMotionOptions& options) {
  HeadMotionSource& source = options.source;
  if (options.noise_mm) source.noise_sd_m = 1e-3 * *options.noise_mm;
  source.delay_s = 1e-3 * options.delay_ms;
  HeadMotionParameters parameters;
  options.stated.apply(parameters);
  parameters.damping_rate_resolution_per_s = options.resolution_per_s;
  refuse_same_files({source.recording, source.acceleration, source.choice.reading.profile},
                    {options.out});
  const IdentifiedHeadMotion motion = identify_head_motion(source, parameters);

  std::unique_ptr<OutputFolder> folder;
  std::vector<std::unique_ptr<OutputFile>> files;
  if (!options.figures.empty() && !motion.course.empty()) {
    folder = std::make_unique<OutputFolder>(options.figures);
    files = draw_head_motion(options.figures, motion);
  }
  if (!options.out.empty()) {
    files.push_back(std::make_unique<OutputFile>(options.out));
    files.back()->write(head_motion_json(motion));
    files.back()->close();
  }
  std::string text = banner() + head_motion_text(motion);
  if (!options.figures.empty() && motion.course.empty()) {
    text += "figures             none: there are no values to draw\n";
  }
  text += commit_all(files);
  print_output(text);
  return kExitOk;
}

}  // namespace

Command add_plan_head_motion(CommandLine protocol) {
  struct Planned {
    HeadMotionPlan plan;
    Stated stated{.muscle_share = 0};
  };
  auto planned = std::make_shared<Planned>();
  HeadMotionPlan& plan = planned->plan;
  const CommandLine command = protocol.add_command(
      "plan-head-motion", "Print the expected standard deviation, and how long to record");
  command.add_example("condyle protocol plan-head-motion --amplitude-mm 10 --frequency-Hz 2",
                      "Plan a head motion: what precision to expect.");
  command.add_example("condyle protocol plan-head-motion --wanted-damping-rate-sd-per-s 0.1",
                      "How long to record for kv/m with this standard deviation.");
  const auto add = [&](const char* name, double& value, const char* meaning, Range range) {
    command.add_option(name, value, meaning).number_in(range).show_default();
  };
  add("--rate-Hz", plan.rate_Hz, "Samples per second, of positions and accelerations", {1, 1e3});
  add("--noise-mm", plan.noise_mm, "Standard deviation of a measured position", {1e-6, 100});
  add("--acceleration-noise-m-s2", plan.acceleration_noise_sd_m_s2,
      "Standard deviation of a measured acceleration", kPositive);
  add("--duration-s", plan.duration_s, "Length of the recording", {1, 900});
  add("--amplitude-mm", plan.amplitude_mm, "Amplitude of the head motion along the axis",
      {1e-3, 1e3});
  add("--frequency-Hz", plan.frequency_Hz, "Frequency of the head motion", {1e-2, 100});
  add("--damping-rate-per-s", plan.damping_rate_per_s, "Expected kv/m", {0, 1e4});
  add("--natural-frequency-Hz", plan.natural_frequency_Hz,
      "Expected natural frequency, sqrt(ks/m) / (2 pi)", {1e-2, 100});
  planned->stated.add_to(command);
  command
      .add_option("--wanted-damping-rate-sd-per-s", plan.wanted_damping_rate_sd_per_s,
                  "Target standard deviation of kv/m")
      .number_in({1e-9, 1e9});
  return [planned] {
    planned->stated.apply(planned->plan.stated);
    print_output(plan_text(planned->plan));
    return kExitOk;
  };
}

Command add_head_motion(CommandLine protocol) {
  auto options = std::make_shared<HeadMotionOptions>();
  const CommandLine command = protocol.add_command(
      "head-motion",
      "Identify kv/m and ks/m of a relaxed jaw from its response to the head's acceleration");
  command.add_example(
      "condyle protocol head-motion nods.csv --acceleration nods.head.csv --muscle-share 0",
      "The acceleration in its own file; the jaw is relaxed.");
  command.add_example(
      "condyle protocol head-motion nods.csv --acceleration nods.head.csv --muscle-share 0.1",
      "Muscles add at most a tenth of the inertial force.");
  HeadMotionSource& source = options->source;
  command.add_option("RECORDING", source.recording, "As for replay; relative to the head")
      .required();
  command.add_option("--acceleration=FILE", source.acceleration,
                     "Head acceleration along the followed axis, gravity included, positive as the "
                     "position: CSV with time_s and acceleration_m_s2; else a column of RECORDING");
  command
      .add_option("--acceleration-noise-m-s2", source.acceleration_noise_sd_m_s2,
                  "Stated noise of each sample, for comparison with the noise found")
      .number_in(kPositive);
  command.add_option("--acceleration-delay-ms", options->delay_ms, "Delay of its time stamps")
      .number_in({-1000, 1000})
      .show_default();
  options->stated.add_to(command);
  add_recording_options(command, source.choice);
  command
      .add_option("--noise-mm", options->noise_mm,
                  "Standard deviation of a measured position, for comparison with the noise found")
      .number_in({1e-6, 100});
  command.add_option("--begin-s", source.begin_s, "First time, from the first sample")
      .number_in(kTimes);
  command.add_option("--end-s", source.end_s, "Last time, from the first sample").number_in(kTimes);
  command
      .add_option("--damping-rate-resolution-per-s", options->resolution_per_s,
                  "Smallest difference of kv/m that matters to you; a value counts as measured if "
                  "known to half of it")
      .number_in({1e-9, 1e9})
      .show_default();
  command.group("Output").add_option("-o,--out=FILE", options->out, "JSON file for the values");
  command.group("Output").add_option("--figures=FOLDER", options->figures,
                                     "Folder for figures (SVG and PNG)");
  return [options] { return run(*options); };
}

}  // namespace condyle::host
