// SPDX-License-Identifier: Apache-2.0
#include "protocols/emg/muscle_file.h"

#include <fmt/format.h>

#include "hosted/files/input_error.h"
#include "hosted/files/toml_reader.h"

namespace condyle::host {
namespace {

void read_jaw(TomlReader& file, JawGeometry& jaw) {
  std::size_t motion = 0;
  file.choice("jaw", "motion", motion, {"hinge", "translation"});
  jaw.motion = motion == 0 ? JawMotion::hinge : JawMotion::translation;
  file.number("jaw", "incisor_radius_m", jaw.incisor_radius_m, "m", {0.01, 0.5});
  file.number("jaw", "incisor_angle_rad", jaw.incisor_angle_rad, "rad", {-1, 1});
}

void read_muscle(TomlReader& file, const std::string& name, MuscleFile& muscles) {
  const std::string section = "muscles." + name;
  MuscleParameters& muscle = muscles.set.muscle.at(muscles.set.count++);
  EmgChannel channel;
  channel.muscle = name;
  channel.column = name + "_envelope";
  file.text(section, "column", channel.column);
  channel.has_maximum =
      file.number(section, "maximum", channel.maximum, "the column's unit", {1e-12, 1e12});
  file.number(section, "maximum_force_N", muscle.maximum_force_N, "N", {1e-3, 1e4});
  if (!file.number(section, "arm", muscle.arm, "m, or the cosine of its angle", {-1, 1})) {
    throw InputError(file.place("muscles", name), fmt::format("no arm of {}", name),
                     "give arm, in m if the jaw is a hinge (negative closes), otherwise the cosine "
                     "of the angle to the axis");
  }
  file.number(section, "optimal_length_m", muscle.optimal_length_m, "m", {1e-3, 1});
  muscles.channels.push_back(channel);
}

}  // namespace

MuscleFile load_muscles(const std::string& path) {
  TomlReader file(path);
  MuscleFile muscles;
  read_jaw(file, muscles.set.jaw);
  const std::vector<std::string> names = file.sections_in("muscles");
  if (names.empty()) {
    throw InputError(path, "lacks a muscle", "add a section [muscles.NAME] for each EMG channel");
  }
  if (names.size() > kMostMuscles) {
    throw InputError(file.place("muscles", names[kMostMuscles]),
                     fmt::format("{} muscles", names.size()),
                     fmt::format("the maximum is {}; leave some out", kMostMuscles));
  }
  for (const std::string& name : names) read_muscle(file, name, muscles);
  visit_emg_fields(muscles.identification,
                   [&file](const char* key, double& value, const char* unit, Range range) {
                     file.number("identification", key, value, unit, range);
                   });
  EnvelopeParameters& envelope = muscles.envelope;
  file.number("envelope", "high_pass_Hz", envelope.high_pass_Hz, "Hz", {0.1, 1e4});
  file.number("envelope", "low_pass_Hz", envelope.low_pass_Hz, "Hz", {0.1, 1e4});
  file.number("envelope", "saturation", envelope.saturation, "the columns' unit", {0, 1e12});
  file.number("envelope", "longest_hold_s", envelope.longest_hold_s, "s", {0, 1e3});
  file.finish();
  return muscles;
}

}  // namespace condyle::host
