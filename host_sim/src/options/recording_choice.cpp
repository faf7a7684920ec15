// SPDX-License-Identifier: Apache-2.0
#include "options/recording_choice.h"

#include <fmt/format.h>

#include <sys/stat.h>

#include <set>
#include <utility>

#include "hosted/files/input_error.h"
#include "options/command_line.h"

namespace condyle::host {
namespace {

CommandLine group_of(CommandLine command) {
  return command.group("What is read and followed");
}

}  // namespace

void add_followed_options(CommandLine line, FollowedChoice& choice, JawPoints jaw_points) {
  const CommandLine command = group_of(line);
  const Option point = command.add_option("--point", choice.followed.point, "Point to follow")
                           .within(1, 3)
                           .show_default();
  const auto take_axis = [&choice](const std::string& axis) {
    choice.followed.axis = static_cast<Axis>(axis[0] - 'x');
    choice.axis_given = true;
  };
  command.on_option("--axis", take_axis, "Axis to follow")
      .one_of({"x", "y", "z"})
      .show_default("z");
  if (jaw_points == JawPoints::no) return;
  command
      .add_option("--jaw-point-mm", choice.jaw_point_mm,
                  "X Y Z of a point fixed to the jaw, in the frame of the three points (origin "
                  "point 1, x from point 3 to 2, z in their plane towards the middle of 2 and 3)")
      .values(3)
      .number_in({-1000, 1000})
      .excludes(point);
}

void RecordingChoice::add_to(CommandLine line, JawPoints jaw_points) {
  add_followed_options(line, *this, jaw_points);
  const CommandLine command = group_of(line);
  const auto take_faults = [this](const std::string& policy) {
    reading.faults = policy == "event" ? FaultPolicy::event : FaultPolicy::refuse;
  };
  command
      .on_option("--faults", take_faults, "What to do with missing, non-finite and reversed rows")
      .one_of({"refuse", "event"})
      .show_default("refuse");
  add_reading_options(command, reading);
}

void add_reading_options(CommandLine command, RecordingOptions& reading) {
  command
      .add_option("--ignore-column", reading.ignored_columns,
                  "CSV column to ignore; may be given several times")
      .one_value_each();
  command.add_option("--profile=FILE", reading.profile,
                     fmt::format("{}; a capture needs it, a session log has one", kProfileMeaning));
  const auto take_unit = [&reading](const std::string& unit) {
    reading.units_per_metre = unit == "mm" ? 1000 : 1;
  };
  command.on_option("--unit", take_unit, "Unit of the coordinates, if the format does not state it")
      .one_of({"mm", "m"});
  command.add_option("--movement", reading.movement, "Movement of a Zebris XML file")
      .within(1, 1'000'000)
      .show_default();
}

void refuse_repeated_recordings(const std::vector<std::string>& sources) {
  std::set<std::string> names;
  std::set<std::pair<dev_t, ino_t>> files;
  for (const std::string& source : sources) {
    struct stat file = {};
    const bool is_known =
        !names.insert(source).second || (stat(source_of(source).file.c_str(), &file) == 0 &&
                                         !files.insert({file.st_dev, file.st_ino}).second);
    if (is_known) throw InputError(source, "is given twice", "give each recording once");
  }
}

}  // namespace condyle::host
