// SPDX-License-Identifier: Apache-2.0
#include "options/recording_choice.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <set>
#include <utility>

#include "hosted/files/input_error.h"
#include "options/command_line.h"

namespace condyle::host {

void RecordingChoice::add_to(CommandLine line) {
  const CommandLine command = line.group("What is read and followed");
  command.add_option("--point", followed.point, "Point to follow").within(1, 3).show_default();
  const auto take_axis = [this](const std::string& axis) {
    followed.axis = static_cast<Axis>(axis[0] - 'x');
    axis_given = true;
  };
  command.on_option("--axis", take_axis, "Axis to follow")
      .one_of({"x", "y", "z"})
      .show_default("z");
  const auto take_faults = [this](const std::string& policy) {
    reading.faults = policy == "event" ? FaultPolicy::event : FaultPolicy::refuse;
  };
  command
      .on_option("--faults", take_faults, "What to do with missing, non-finite and reversed rows")
      .one_of({"refuse", "event"})
      .show_default("refuse");
  command
      .add_option("--ignore-column", reading.ignored_columns,
                  "CSV column to leave unread; may be given several times")
      .one_value_each();
  command.add_option("--profile=FILE", reading.profile,
                     "TOML file that describes the device of a capture");
  const auto take_unit = [this](const std::string& unit) {
    reading.units_per_metre = unit == "mm" ? 1000 : 1;
  };
  command.on_option("--unit", take_unit, "Unit of coordinates where the format states none")
      .one_of({"mm", "m"});
  command.add_option("--movement", reading.movement, "Movement of a Zebris XML file")
      .within(1, 1'000'000)
      .show_default();
}

void RecordingChoice::check(const std::string& source, const RecordingInfo& info) const {
  if (!is_available(info.kind, followed)) {
    throw InputError(source, fmt::format("has one point, not point {}", followed.point),
                     "leave out --point");
  }
  if (info.kind == SampleKind::one_axis && axis_given) {
    throw InputError(source, "has one axis, so there is none to choose", "leave out --axis");
  }
}

void refuse_repeated_recordings(const std::vector<std::string>& sources) {
  std::set<std::string> names;
  std::set<std::pair<dev_t, ino_t>> files;
  for (const std::string& source : sources) {
    struct stat file = {};
    const bool is_known =
        !names.insert(source).second || (stat(source_of(source).file.c_str(), &file) == 0 &&
                                         !files.insert({file.st_dev, file.st_ino}).second);
    if (is_known) throw InputError(source, "is named twice", "name each recording once");
  }
}

}  // namespace condyle::host
